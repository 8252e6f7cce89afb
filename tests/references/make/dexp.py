"""Reference values of dexp, dexp^-1 and the Pade (2,2) map at hard arguments: writes dexp.json.

Conventions as in maps.py (its functions are used).  Matrices row-major, inputs are doubles
(repr), results have 30 digits.  Groups: so (M = 1), sp, gl, lorentz = so(3,1), so22 = so(2,2),
gm = u(m) as G_M with M = 1 + J.
    dexp      sum_k ad_u^k v/(k+1)!, summed at high precision; checked by central differences of exp
    dexpinv   with u = V diag(l) V^-1: X = V^-1 v V, X_jk *= z/(e^z - 1), z = l_j - l_k; entries
              that the algebra does not reach are zero exactly and stay zero (spurious poles at
              2 a_j = 2 pi k).  Checked by dexp(dexpinv) = v
    distance  smallest |z - 2 pi i k|, k != 0, over the eigenvalues z of ad_u on the algebra
    pade      Psi(u);  dpadeinv  the inverse differential, checked by central differences
cond_dexpinv: from the largest |phi(z)|, |z phi'(z)| over the pairs seen by the algebra and the
condition number of V: (|V||V^-1|)^2 (max|phi| + |u| max|phi'|) |v|/|w|.
"""
import math
import random

from mpmath import mp, mpf

from .maps import (add, commutator, expm, eye, gl_element, inverse, lorentz_element,
                       matmul, norm, scaled, so_element, sp_element, spectral)

from .schema import case, exact, flat, value, write

mp.dps = 70
TOL = mpf(10) ** -32


def so22_element(rng, n):
    a = so_element(rng, 4)
    for i in (0, 1):
        for j in (2, 3):
            a[i][j] = a[j][i]
    return a


def u_element(rng, n):
    """u(m) in 2m dimensions: [[A, B], [-B, A]], A skew, B symmetric."""
    m = n // 2
    a = so_element(rng, m)
    b = [[rng.gauss(0, 1) for _ in range(m)] for _ in range(m)]
    b = [[b[max(i, j)][min(i, j)] for j in range(m)] for i in range(m)]
    return [[a[i][j] for j in range(m)] + [b[i][j] for j in range(m)] for i in range(m)] + \
           [[-b[i][j] for j in range(m)] + [a[i][j] for j in range(m)] for i in range(m)]


def dexp(u, v):
    total, term, k = v, v, 1
    while norm(term) > mp.eps * norm(total):
        k += 1
        term = scaled(commutator(u, term), mpf(1) / k)
        total = add(total, term)
    return total


def phi(z):
    return z / mp.expm1(z) if abs(z) > mpf(10) ** -30 else mpf(1)


def dphi(z):
    return mp.diff(phi, z) if abs(z) > mpf(10) ** -5 else mpf(-1) / 2


def seen(kind, lam, V, Vi, n):
    """Pairs (j, k) whose component V e_j (e_k^T V^-1) the algebra reaches: all on gl and sp; on a
    symmetric form not l_j = -l_k with k the partner of j; on u(m) the commutant of J only."""
    pairs = []
    for j in range(n):
        for k in range(n):
            if kind in ("so", "lorentz", "so22") and abs(lam[j] + lam[k]) < mpf(10) ** -20 \
                    and abs(lam[j]) > mpf(10) ** -20:
                continue
            if kind == "u":
                m = n // 2
                J = [[int(c == r + m) - int(r == c + m) for c in range(n)] for r in range(n)]
                E = matmul([[V[r][j]] for r in range(n)], [[Vi[k][c] for c in range(n)]])
                if norm(commutator(J, E)) > mpf(10) ** -20:
                    continue
            pairs.append((j, k))
    return pairs


def reference(ident, kind, uf, vf):
    n = len(uf)
    u = [[mpf(x) for x in r] for r in uf]
    v = [[mpf(x) for x in r] for r in vf]
    size = norm(u)
    with mp.workdps(70 + int(2 * size)):
        lam, V = mp.eig(mp.matrix(u))
        lam, V = list(lam), V.tolist()
        Vi = inverse(V)
        X = matmul(matmul(Vi, v), V)
        pairs = seen(kind, lam, V, Vi, n)
        distance, top, slope = mp.inf, mpf(1), mpf(1) / 2
        for j in range(n):
            for k in range(n):
                z = lam[j] - lam[k]
                if (j, k) not in pairs:
                    assert abs(X[j][k]) < mpf(10) ** -25 * norm(v), (ident, j, k, X[j][k])
                    X[j][k] = mpf(0)
                    continue
                for turn in range(1, int(size) + 3):
                    for s in (turn, -turn):
                        distance = min(distance, abs(z - 2j * mp.pi * s))
                X[j][k] *= phi(z)
                top, slope = max(top, abs(phi(z))), max(slope, abs(dphi(z)))
        w = matmul(matmul(V, X), Vi)
        assert max(abs(mp.im(x)) for x in flat(w)) < TOL * norm(w), ident
        w = [[mp.re(x) for x in r] for r in w]
        forward = dexp(u, v)
        kappa = float(norm(V) * norm(Vi)) / n
        cond = kappa ** 2 * float((top + size * slope) * norm(v) / norm(w))
        error = norm(add(dexp(u, w), v, -1)) / norm(v) / max(1, cond)
        assert error < TOL, (ident, error)
        h = mpf(10) ** -40
        slope_of = lambda f, d: matmul(scaled(add(f(add(u, d, h)), f(add(u, d, -h)), -1), 1 / (2 * h)),
                                       inverse(f(u)))
        with mp.workdps(150 + int(4 * size)):
            error = norm(add(slope_of(expm, v), forward, -1)) / norm(forward)
        assert error < TOL, (ident, error)

    def pade(a):
        square = scaled(matmul(a, a), mpf(1) / 12)
        even = add(eye(n), square)
        return matmul(inverse(add(even, a, mpf(-1) / 2)), add(even, a, mpf(1) / 2))

    p = pade(u)
    # dPsi^-1 by the n^2 x n^2 system of the differential of D^-1 N.
    square = scaled(matmul(u, u), mpf(1) / 12)
    D, N = add(add(eye(n), square), u, mpf(-1) / 2), add(add(eye(n), square), u, mpf(1) / 2)
    Di, Ni = inverse(D), inverse(N)
    rows = []
    for a in range(n):
        for b in range(n):
            e = [[mpf(int((i, j) == (a, b))) for j in range(n)] for i in range(n)]
            ds = scaled(add(matmul(e, u), matmul(u, e)), mpf(1) / 12)
            dD, dN = add(ds, e, mpf(-1) / 2), add(ds, e, mpf(1) / 2)
            # d(D^-1 N) (D^-1 N)^-1 = D^-1 (dN N^-1 D - dD)
            rows.append(flat(matmul(Di, add(matmul(matmul(dN, Ni), D), dD, -1))))
    system = mp.matrix(rows).T
    try:
        q = mp.lu_solve(system, mp.matrix(flat(v)))
        q = [[q[i * n + j] for j in range(n)] for i in range(n)]
        with mp.workdps(150):
            hh = mpf(10) ** -40
            diff = scaled(add(pade(add(u, q, hh)), pade(add(u, q, -hh)), -1), 1 / (2 * hh))
            assert norm(add(matmul(diff, inverse(p)), v, -1)) < mpf(10) ** -25 * (1 + norm(q)) ** 3, ident
    except ZeroDivisionError:
        q = None
    text = lambda a: None if a is None else [mp.nstr(x, 30) for x in flat(a)]
    short = f"{max(1.0, cond):.3g}"
    return case(ident, "gm" if kind == "u" else kind, n, {"u": exact(flat(uf)), "v": exact(flat(vf))}, {
        "dexp": value(text(forward), cond=short), "dexpinv": value(text(w), cond=short),
        "distance": value([mp.nstr(distance, 17)]), "pade": value(text(p)), "dpadeinv": value(text(q))})


def main():
    rng = random.Random(11)
    elements = {"so": so_element, "sp": sp_element, "gl": gl_element, "lorentz": lorentz_element,
                "so22": so22_element, "u": u_element}
    out = []
    for kind, n, sizes in [("so", 3, (0.5, 3.14, 10)), ("so", 6, (1, 4)), ("sp", 4, (0.4, 2, 5, 15)),
                           ("gl", 3, (0.4, 2, 6, 20)), ("gl", 6, (5,)), ("lorentz", 4, (0.4, 2, 5, 15)),
                           ("so22", 4, (2, 6)), ("u", 4, (1, 4)), ("u", 6, (3,))]:
        for size in sizes:
            uf, vf = elements[kind](rng, n), elements[kind](rng, n)
            uf, vf = scaled(uf, size / spectral(uf)), scaled(vf, 1 / spectral(vf))
            out.append(reference(f"{kind}{n}_{size}", kind, uf, vf))
    # Rotation by nearly pi in SO(3,1): gl(4) sees a pole at 2 a = 2 pi that so(3,1) does not.
    for a in (math.pi, math.pi - 1e-9, 3.14):
        uf = [[0.0, -a, 0.0, 0.0], [a, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.25], [0.0, 0.0, 0.25, 0.0]]
        out.append(reference(f"lorentz4_rotation_{a!r}", "lorentz", uf, scaled(lorentz_element(rng, 4), 0.5)))
    # Distance 1e-3 ... 1e-9 to a pole that sp(2) sees: eigenvalues +-i a, 2 a = 2 pi - 2 delta.
    for delta in (1e-3, 1e-6, 1e-9):
        a = math.pi - delta
        out.append(reference(f"sp2_near_pole_{delta}", "sp", [[0.0, a], [-a, 0.0]], sp_element(rng, 2)))
    # Real spread 40 with an off-diagonal part in either triangle: grading and its order.
    for ident, uf in (("gl3_spread_up", [[-20.0, 3.0, 1.0], [0.0, 1.0, 2.0], [0.0, 0.0, 20.0]]),
                      ("gl3_spread_down", [[20.0, 3.0, 1.0], [0.0, 1.0, 2.0], [0.0, 0.0, -20.0]]),
                      ("gl3_shifted", [[500.0, 3.0, 1.0], [4.0, 501.0, 2.0], [0.0, 1.0, 499.0]])):
        out.append(reference(ident, "gl", uf, gl_element(rng, 3)))
    write("dexp", "The differential of exp and its inverse beyond the reach of the series, the distance to the "
          "singular set, the Pade map.", out)
