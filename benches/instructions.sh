#!/bin/sh
# Counts the instructions of a call of each map with callgrind, and compares them with benches/instructions.toml.
# It fails if one differs by more than 2 %. `--record` writes the file again. Needs valgrind.
set -eu
cd "$(dirname "$0")/.."
file=benches/instructions.toml
bench=$(cargo test --release --bench instructions --no-run 2>&1 | sed -n "s/.*instructions.rs (\(.*\))$/\1/p")
counted() { # NAME CALLS
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$bench" "$1" "$2" 2>&1 |
        sed -n 's/.*Collected : *//p'
}
found=$(for name in $("$bench"); do
    # The difference of two runs, because both contain the start of the process.
    few=$(counted "$name" 200)
    many=$(counted "$name" 600)
    echo "$name = $(((many - few) / 400))"
done)
if [ "${1:-}" = --record ]; then
    {
        echo "# Instructions a call, default x86-64 build under callgrind (which offers AVX2, not AVX-512)."
        echo "$found"
    } >"$file"
    cat "$file"
    exit
fi
echo "$found" | awk -F ' = ' -v file="$file" '
    BEGIN { while ((getline line < file) > 0) { split(line, part, " = "); kept[part[1]] = part[2] } }
    {
        if (!($1 in kept)) { print $1 ": not in " file; bad = 1; next }
        change = 100 * ($2 / kept[$1] - 1)
        printf "%-18s %7d, was %7d (%+.1f %%)\n", $1, $2, kept[$1], change
        if (change > 2 || change < -2) bad = 1
    }
    END { exit bad }'
