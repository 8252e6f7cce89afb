"""Reference values of the closed forms on so(3) that maps.json does not hold: writes so3.json.

Inputs are IEEE doubles (repr); references belong to their exact values, 36 digits.  Differentials
are right-trivialised.  Formulas are those of maps.py, and

    dexp    v + (1 - cos a)/a^2 u x v + (a - sin a)/a^3 u x (u x v)
    dcay    (v + u x v/2)/(1 + a^2/4)
    dccsk   v_i e_i + v_j R_i e_j + v_k R_i R_j e_k
    log     of the polar factor of R: R <- (R + R^-T)/2 to convergence, then the quaternion of
            the largest component and 2 atan2(|q|, q_w) q/|q|

Checked: every derivative by central differences of its map, every logarithm by exp(log R) = R.
Condition numbers as in maps.py.

The maps: dexp, dexpinv, dcay, and the six orderings of ccsk with dccsk and dccsk^-1.
The logarithms: R by rows, its logarithm, and its distance from the group.

`python3 -c "from make.so3 import series; series()"` prints the polynomials in a^2 of src/so3/angle.rs.
"""
import itertools
import math
import random

from mpmath import mp, mpf

from .maps import (add, ccsk, condition3, cross, dccskinv, dexpinv3, digits, exp3, eye, group,
                   hat, inverse, matmul, norm, scaled, transpose)
from .schema import case, check, exact, flat, value, write

ORDERS = list(itertools.permutations(range(3)))


def dexp3(u, v):
    a = norm(u)
    if not a:
        return list(v)
    with mp.workdps(mp.dps + max(0, int(-3 * mp.log10(a)) + 5)):
        b, d = (1 - mp.cos(a)) / a ** 2, (a - mp.sin(a)) / a ** 3
    uv = cross(u, v)
    return [x + b * y + d * z for x, y, z in zip(v, uv, cross(u, uv))]


def dcay3(u, v):
    s = 1 + sum(x * x for x in u) / 4
    return [(x + y / 2) / s for x, y in zip(v, cross(u, v))]


def cay3(u):
    h, s = hat(u), 1 + sum(x * x for x in u) / 4
    return add(add(eye(3), h, 1 / s), matmul(h, h), 1 / (2 * s))


def dccsk(order):
    def value(u, v):
        left, out = eye(3), [mpf(0)] * 3
        for i in order:
            out = [x + v[i] * row[i] for x, row in zip(out, left)]
            left = matmul(left, exp3([u[i] if j == i else mpf(0) for j in range(3)]))
        return out
    return value


def polar(r):
    for _ in range(60):
        r2 = scaled(add(r, transpose(inverse(r))), mpf(1) / 2)
        if norm(add(r2, r, -1)) < mpf(10) ** (5 - mp.dps):
            return r2
        r = r2
    raise ArithmeticError("polar")


def log3(r):
    t = r[0][0] + r[1][1] + r[2][2]
    cases = [[1 + t, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        q = [mpf(0)] * 4
        q[0] = r[k][j] - r[j][k]
        q[1 + i] = 1 + r[i][i] - r[j][j] - r[k][k]
        q[1 + j], q[1 + k] = r[i][j] + r[j][i], r[i][k] + r[k][i]
        cases.append(q)
    q = max(cases, key=norm)
    if q[0] < 0:
        q = [-x for x in q]
    size = norm(q[1:])
    return [2 * mp.atan2(size, q[0]) / size * x if size else mpf(0) for x in q[1:]]


def point(size, d):
    length = math.sqrt(sum(x * x for x in d))
    return tuple(size * (x / length) if x else 0.0 for x in d)


def points():
    pi = math.pi
    directions = [(0.48, -0.6, 0.64), (-0.36, 0.48, 0.8), (0.0, 1.0, 0.0), (1.0, 1e-9, -1e-12), (-0.2, -0.4, -0.9)]
    norms = [0.0, 1e-320, 1e-160, 1e-20, 1e-8, 1e-4, 1e-2, 0.3, 0.7, 0.999, 1.0, 1.001, 1.5, 2.5, 3.0,
             pi - 1e-3, pi - 1e-8, pi, pi + 1e-8, 4.0, 6.0]
    norms += [2 * pi - 10.0 ** -k for k in range(1, 13)] + [2 * pi + 1e-3, 2 * pi + 1e-9, 4 * pi - 1e-6]
    norms += [10.0, 100.0, 1e4, 1e8, 1e15, 1e160, 1e300]
    for i, size in enumerate(norms):
        yield point(size, directions[i % 5])
        if 6.2 < size < 6.3:
            yield point(size, directions[(i + 1) % 5])
    for k in (4, 8, 12):
        yield (0.3, pi / 2 - 10.0 ** -k, -0.7)
        yield (pi / 2 - 10.0 ** -k, 0.2, 1.1)
        yield (-2.0, 0.4, 10.0 ** -k - pi / 2)


def make_maps():
    rng = random.Random(8)
    out = []
    for uf in points():
        vf = tuple(round(rng.gauss(0, 1), 6) for _ in range(3))
        ident, size = str(uf), max(map(abs, uf))
        outputs = {}
        with mp.workdps(200 + (4 * int(math.log10(size)) if size > 1 else 0)):
            u, v = [mpf(x) for x in uf], [mpf(x) for x in vf]
            maps = [("dexp", exp3, dexp3, False), ("dexpinv", exp3, dexpinv3, True), ("dcay", cay3, dcay3, False)]
            for order in ORDERS:
                name = "".join(str(i + 1) for i in order)
                maps.append(("dccsk" + name, ccsk(order), dccsk(order), False))
                maps.append(("dccskinv" + name, ccsk(order), dccskinv(order), True))
                outputs["ccsk" + name] = value(group(flat(ccsk(order)(u))))
            for name, psi, d, inv in maps:
                w = d(u, v)
                cond, _ = condition3(d, u, v)
                if size < 1e100:
                    x, y = (w, v) if inv else (v, w)
                    h = mpf(10) ** -60 / max(1, norm(x), norm(y))
                    gp, gm = (psi([a + s * h * b for a, b in zip(u, x)]) for s in (1, -1))
                    slope = scaled(matmul(add(gp, gm, -1), transpose(psi(u))), 1 / (2 * h))
                    check(name, ident, norm(add(slope, hat(y), -1)) / norm(y))
                outputs[name] = value(group(w), cond=digits(cond, 3))
        out.append(case(f"vector_{len(out)}", "so", 3, {"u": exact(uf), "v": exact(vf)}, outputs))
    return out


def make_log():
    pi = math.pi
    rng = random.Random(5)
    directions = [(0.48, -0.6, 0.64), (-0.36, 0.48, 0.8), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (1e-9, 1e-4, 1.0),
                  (0.6, -0.8, 1e-7), (-0.577, 0.577, -0.578)]
    sizes = [1e-320, 1e-308, 1e-200, 1e-100, 1e-16, 1e-9, 1e-8, 1e-6, 1e-3, 0.1, 0.7, 1.0, 1.5, 2 * pi / 3, 2.2, 3.0]
    sizes += [pi - 10.0 ** -k for k in range(2, 14)] + [pi + 1e-8, 5.0, 2 * pi - 1e-3, 2 * pi - 1e-7]
    cases = []
    for i, size in enumerate(sizes):
        for d in (directions[i % 7], directions[(3 * i + 2) % 7]):
            with mp.workdps(700):
                r = [float(x) for x in flat(exp3([mpf(x) for x in point(size, d)]))]
            cases.append(r)
    for off in (1e-15, 1e-14, 1e-12, 1e-9, 1e-6):
        for size, d in ((0.2, directions[0]), (2.0, directions[1]), (3.1, directions[6])):
            r = exp3([mpf(x) for x in point(size, d)])
            cases.append([float(x) + off * rng.uniform(-1, 1) for x in flat(r)])
    out = []
    for r in cases:
        with mp.workdps(750):
            m = [[mpf(x) for x in r[3 * i:3 * i + 3]] for i in range(3)]
            p = polar(m)
            u = log3(p)
            check("exp(log R)", str(r), norm(add(exp3(u), p, -1)))
            defect = norm(add(matmul(transpose(m), m), eye(3), -1))
            log = value(group(u), defect=digits(defect, 3))
            out.append(case(f"log_{len(out)}", "so", 3, {"g": exact(r)}, {"log": log}))
    return out


def series():
    mp.dps = 60
    f = mp.factorial
    cot, slope = ([abs(mp.bernoulli(2 * k + i)) / f(2 * k + i) for k in range(60)] for i in (2, 4))
    table = {
        "(a - sin a)/a^3": (8, 1, lambda k: (-1) ** k / f(2 * k + 3)),
        "(1 - (a/2) cot(a/2))/a^2": (8, 1, lambda k: cot[k]),
        "its derivative in a^2": (8, 1, lambda k: (k + 1) * slope[k]),
        "sin(a/2)/a": (9, 10, lambda k: (-1) ** k / f(2 * k + 1) / mpf(2) ** (2 * k + 1)),
        "cos(a/2)": (9, 10, lambda k: (-1) ** k / f(2 * k) / mpf(4) ** k),
    }
    for name, (terms, end, taylor) in table.items():
        c = [mpf(taylor(k)) for k in range(60)]
        value = lambda x: sum(t * x ** k for k, t in enumerate(c))
        nodes = [end * (1 + mp.cos(mp.pi * (2 * j + 1) / (2 * terms))) / 2 for j in range(terms)]
        p = mp.lu_solve(mp.matrix([[x ** k for k in range(terms)] for x in nodes]), mp.matrix([value(x) for x in nodes]))
        p = [mpf(float(x)) for x in p]
        # cos(a/2) passes through 0 next to a = pi: there the error is absolute.
        size = lambda x: 1 if name == "cos(a/2)" else value(x)
        error = max(abs((sum(p[k] * x ** k for k in range(terms)) - value(x)) / size(x)) for x in mp.linspace(0, end, 201))
        print(name, "error", mp.nstr(error, 3))
        print("   ", ", ".join(repr(float(x)) for x in p))


def main():
    write("so3", "Closed forms on so(3): differentials, coordinates of the second kind in all orderings, "
          "the logarithm.", make_maps() + make_log())
