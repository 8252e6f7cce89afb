"""Reference values on SE(3): writes se3.json.

Inputs are IEEE doubles (repr); references belong to their exact values, 36 digits, and come from
matrices alone: exp of the 4x4 matrix [hat(w) v; 0 0], and dexp^-1 of the 6x6 matrix
ad = [hat(w) 0; hat(v) hat(w)], as the inverse of phi_1(ad), the upper right block of
exp([ad 1; 0 0]). No closed form is used.

"cond" is what a relative change of one rounding in the entries of w and v can do to the result,
per rounding, plus the size of the result: max_i |f(u + d u_i e_i) - f(u)|/d + |f(u)|.
"""
import random

from mpmath import mp, mpf

from .schema import case, exact, value, write

mp.dps = 90


def hat(u):
    x, y, z = u
    return [[0, -z, y], [z, 0, -x], [-y, x, 0]]


def exp4(u):
    h = hat(u[:3])
    m = mp.matrix(4, 4)
    for i in range(3):
        for j in range(3):
            m[i, j] = h[i][j]
        m[i, 3] = u[3 + i]
    return mp.expm(m, method="taylor")


def motion(u, _):
    g = exp4(u)
    return [g[i, j] for i in range(3) for j in range(3)] + [g[i, 3] for i in range(3)]


def dexpinv(u, a):
    h, k = hat(u[:3]), hat(u[3:])
    m = mp.matrix(12, 12)
    for i in range(3):
        for j in range(3):
            m[i, j] = m[3 + i, 3 + j] = h[i][j]
            m[3 + i, j] = k[i][j]
    for i in range(6):
        m[i, 6 + i] = 1
    e = mp.expm(m, method="taylor")
    phi = mp.matrix(6, 6)
    for i in range(6):
        for j in range(6):
            phi[i, j] = e[i, 6 + j]
    return list(mp.lu_solve(phi, mp.matrix(a)))


def norm(x):
    return mp.sqrt(sum(t * t for t in x))


def condition(f, u, a):
    base, d, worst = f(u, a), mpf(10) ** -35, mpf(0)
    for i in range(6):
        moved = list(u)
        moved[i] *= 1 + d
        worst = max(worst, norm([x - y for x, y in zip(f(moved, a), base)]) / d)
    return base, worst + norm(base)


def main():
    rng = random.Random(6)
    pi = float(mp.pi)
    angles = [0.0, 1e-300, 1e-160, 1e-20, 1e-8, 1e-4, 0.3, 0.5, 0.999, 0.9999999, 1.0000001, 1.5, 2.5,
              pi - 1e-9, pi, pi + 1e-9, 4.0, 5.5, 2 * pi - 1e-2, 2 * pi - 1e-4, 2 * pi + 1e-4, 7.0, 9.0, 12.0, 30.0]
    cases = []
    for k, angle in enumerate(angles):
        w = [rng.gauss(0, 1) for _ in range(3)] if k % 4 else [0.0, 0.0, 1.0]
        size = sum(x * x for x in w) ** 0.5
        w = [x / size * angle for x in w]
        v = [rng.gauss(0, 1) * 10 ** rng.choice([-3, 0, 0, 3]) for _ in range(3)]
        a = [rng.gauss(0, 1) for _ in range(6)]
        u = [mpf(x) for x in w + v]
        g, cond_g = condition(motion, u, None)
        y, cond_y = condition(dexpinv, u, [mpf(x) for x in a])
        digits = lambda xs: [mp.nstr(x, 36) for x in xs]
        cases.append(case(f"twist_{k}", "se", 3, {"u": exact(w + v), "v": exact(a)}, {
            "exp": value(digits(g), cond=mp.nstr(cond_g, 6)),
            "dexpinv": value(digits(y), cond=mp.nstr(cond_y, 6))}))
    write("se3", "exp and its inverse differential on SE(3): u, v = (rotation, translation), g = (rotation by rows, "
          "translation).", cases)
