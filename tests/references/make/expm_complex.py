"""Writes expm_complex.json: the exponential of complex matrices with 34-digit references.

exp of x + iy is read off exp [[x, -y], [y, x]], which expm.py computes. `cond` is the relative
condition number ||K||_2 ||u||_F / ||exp(u)||_F with K the derivative, n <= 3; null where it was not computed.
Needs mpmath alone (30 s).
"""
import random

from mpmath import mp, mpf

from .expm import DIGITS, expm, frechet, norm, spectral
from .schema import case, complex_exact, flat, value, write


def real(z):
    x = [[mpf(e.real) for e in r] for r in z]
    y = [[mpf(e.imag) for e in r] for r in z]
    top = [p + [-t for t in q] for p, q in zip(x, y)]
    return top + [q + p for p, q in zip(x, y)]


def size(z):
    return mp.sqrt(mp.fsum(mpf(e.real) ** 2 + mpf(e.imag) ** 2 for r in z for e in r))


def condition(z, g):
    n = len(z)
    if n > 3:
        return None
    columns = []
    for j in range(n):
        for i in range(n):
            for unit in (1, 1j):
                e = [[complex(unit if (p, q) == (i, j) else 0) for q in range(n)] for p in range(n)]
                d = frechet(real(z), real(e))
                columns.append([d[p][q] for q in range(n) for p in range(2 * n)])
    return spectral(columns) * size(z) * mp.sqrt(2) / norm(g)


def reference(name, structure, z):
    n = len(z)
    mp.dps = 60
    g = expm(real(z))
    assert norm([[a - b for a, b in zip(p, q)] for p, q in zip(g, expm(real(z), 3))]) <= mpf(10) ** -50 * norm(g)
    cond = condition(z, g)
    entries = [(g[i][j], g[i + n][j]) for i in range(n) for j in range(n)]
    exp = value([[mp.nstr(a, DIGITS), mp.nstr(b, DIGITS)] for a, b in entries],
                cond=None if cond is None else mp.nstr(cond, 6))
    return case(name, structure, n, {"u": complex_exact(flat(z))}, {"exp": exp})


def skew(z):
    n = len(z)
    return [[(z[i][j] - z[j][i].conjugate()) / 2 for j in range(n)] for i in range(n)]


def main():
    rng = random.Random(3)
    cases = []
    for n in (1, 2, 3, 5, 8, 13):
        for target in (1e-12, 0.04, 0.25, 0.9, 4.0, 30.0, 1e4):
            z = [[complex(rng.gauss(0, 1), rng.gauss(0, 1)) for _ in range(n)] for _ in range(n)]
            u = skew(z)
            f = target / float(size(u))
            u = skew([[f * e for e in r] for r in u])
            cases.append(reference(f"u({n}) {target:g}", "u", u))
            if target <= 30:
                f = target / float(size(z))
                cases.append(reference(f"gl({n}) {target:g}", "gl", [[f * e for e in r] for r in z]))
    # A trace to take out, a Jordan block, a nilpotent, a phase beyond all turns.
    cases.append(reference("shift", "gl", [[300 + 200j, 1], [0.5j, 300 + 201j]]))
    cases.append(reference("jordan", "gl", [[2j, 1 + 0j, 0j], [0j, 2j, 1 + 0j], [0j, 0j, 2j]]))
    cases.append(reference("nilpotent", "gl", [[0j, 5 + 5j, 1j], [0j, 0j, 3 + 0j], [0j, 0j, 0j]]))
    cases.append(reference("phase", "u", [[1e6j, 0.5 + 0j], [-0.5 + 0j, 1e6j]]))
    write("expm_complex", "exp of complex matrices.", cases)
