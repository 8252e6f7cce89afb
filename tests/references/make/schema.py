"""The schema of the reference files, and what the modules that write them share."""
import json
import os

from mpmath import mp, mpf

WORST = {}


def check(what, ident, error, tolerance=mpf(10) ** -33):
    """Two computations agree; the worst disagreement is printed at the end."""
    assert error < tolerance, (what, ident, mp.nstr(error, 5))
    WORST[what] = max(WORST.get(what, (mpf(0), "")), (error, ident))


def flat(a):
    return [x for r in a for x in r]


def exact(entries):
    """Inputs: the shortest strings that parse to these doubles."""
    return [repr(float(x)) for x in entries]


def complex_exact(entries):
    return [[repr(x.real), repr(x.imag)] for x in entries]


def value(entries, **measures):
    """What a function gives, with measures of it by name; those that are not known are left out."""
    return {"value": entries, **{k: x for k, x in measures.items() if x is not None}}


def case(ident, group, n, inputs, outputs):
    return {"id": ident, "group": group, "n": n, "input": inputs, "output": outputs}


def write(name, description, cases):
    assert len({c["id"] for c in cases}) == len(cases) or name == "fluids"
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", name + ".json")
    with open(path, "w") as f:
        f.write('{"description": %s,\n"cases": [\n%s\n]}\n'
                % (json.dumps(description), ",\n".join(json.dumps(c) for c in cases)))
    print(name, len(cases), "cases,", os.path.getsize(path), "bytes")
    for what, (error, ident) in sorted(WORST.items()):
        print(f"  worst disagreement {what}: {mp.nstr(error, 3)} ({ident})")
