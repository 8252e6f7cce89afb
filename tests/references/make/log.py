"""Reference logarithms of matrix groups: writes log.json.

g is a matrix of IEEE doubles (repr, row-major), the rounded exponential of a u in the algebra or a
product of such; log is the principal logarithm of exactly that matrix, 30 digits, by the
eigendecomposition at 120 digits; checked by the Taylor exponential of maps.py.  g is on its
group only to rounding, and so is its logarithm in the algebra: the comparison allows for it with

    cond = |L| |g|/|log g|,  L the Frechet derivative of log at g in the Frobenius norm

by divided differences in the eigenbasis and power iteration.  The forms are those of maps.py:
so(n); sp(n), form [[0,1],[-1,0]]; gl(n); lorentz, so(3,1).
"""
import cmath
import math
import random

from mpmath import mp, mpf

from .maps import (add, divided, expm, gl_element, group, lorentz_element, matmul,
                  norm, operator_norm, so_element, sp_element, spectral, star)
from .schema import case, check, exact, flat, value, write


def cond_log(lam, V, Vi, size, log_size):
    n = len(lam)
    lam = [complex(x) for x in lam]
    V, Vi = ([[complex(x) for x in r] for r in a] for a in (V, Vi))
    Vs, Vis = star(V), star(Vi)

    def f(z, w):
        return 1 / z if abs(z - w) < 1e-7 * abs(z) else divided(cmath.log, z, w)

    coef = [[f(z, w) for w in lam] for z in lam]

    def through(left, inner, right, c):
        def apply(x):
            y = matmul(matmul(left[0], x), left[1])
            y = [[p * q for p, q in zip(r, s)] for r, s in zip(c, y)]
            return matmul(matmul(right[0], y), right[1])
        return apply

    conj = [[c.conjugate() for c in r] for r in coef]
    L = operator_norm(through((Vi, V), None, (V, Vi), coef), through((Vs, Vis), None, (Vis, Vs), conj), n)
    return L * size / log_size


def cases():
    rng = random.Random(12)
    kinds = {"so": so_element, "sp": sp_element, "gl": gl_element, "lorentz": lorentz_element}
    for kind, sizes, norms in (("so", (2, 3, 4, 5, 8), (1e-6, 0.1, 1.0, 2.5, 3.1)),
                               ("sp", (2, 4, 6), (1e-6, 0.2, 1.0, 2.5)),
                               ("gl", (1, 2, 3, 5), (1e-6, 0.2, 1.0, 3.0)),
                               ("lorentz", (4,), (1e-6, 0.2, 1.0, 3.0))):
        for n in sizes:
            for size in norms:
                a = kinds[kind](rng, n)
                s = size / spectral(a)
                yield f"{kind}{n}_{size}", kind, n, [[x * s for x in r] for r in a]
    # Nearly a half turn, two planes of nearly the same angle, a wide spread.
    pi = math.pi

    def planes(*angles):
        n = 2 * len(angles)
        out = [[0.0] * n for _ in range(n)]
        for i, a in enumerate(angles):
            out[2 * i][2 * i + 1], out[2 * i + 1][2 * i] = -a, a
        return out

    yield "so4_near_pi", "so", 4, planes(pi - 1e-6, 1.0)
    yield "so4_near_isoclinic", "so", 4, planes(2.0, 2.0 + 1e-6)
    yield "so6_mixed", "so", 6, planes(1e-5, 3.1, 0.7)
    yield "sp2_hyperbolic", "sp", 2, [[9.0, 0.0], [0.0, -9.0]]
    yield "sp2_shear", "sp", 2, [[0.5, 40.0], [0.0, -0.5]]
    yield "gl2_wide", "gl", 2, [[-20.0, 3.0], [0.0, 12.0]]
    yield "gl3_turning", "gl", 3, [[0.1, -3.0, 0.2], [3.0, 0.2, 0.0], [0.0, 0.4, 1.0]]


def main():
    mp.dps = 120
    out = []
    for ident, kind, n, u in cases():
        g = [[float(x) for x in r] for r in expm([[mpf(x) for x in r] for r in u])]
        rounded = [[mpf(x) for x in r] for r in g]
        lam, V = mp.eig(mp.matrix(rounded))
        Vi = V ** -1
        full = V * mp.diag([mp.log(x) for x in lam]) * Vi
        check("imaginary part", ident, max(abs(mp.im(x)) for x in full))
        log = [[mp.re(full[i, j]) for j in range(n)] for i in range(n)]
        check("exp(log g)", ident, norm(add(expm(log), rounded, -1)) / norm(rounded))
        cond = cond_log(lam, V.tolist(), Vi.tolist(), float(norm(rounded)), float(norm(log)))
        out.append(case(ident, kind, n, {"g": exact(flat(g))},
                        {"log": value(group(flat(log), 30), cond=f"{cond:.3g}")}))
    write("log", "Principal logarithms.", out)
