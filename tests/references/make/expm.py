"""Writes expm.json: hard cases of the matrix exponential with 34-digit references.

The named families are rebuilt from their published definitions. The reference is a Taylor series
with scaling and squaring at a precision that covers the condition of the case, computed twice with
different precision and scaling. `cond` is the relative condition number of exp at u for normwise
perturbations, ||K||_2 ||u||_F / ||exp(u)||_F, `mixed` that for entrywise ones,
|| |K| vec|u| ||_2 / ||exp(u)||_F, with K the matrix of the Frechet derivative (n <= 8).
Needs mpmath alone.
"""
import math
import sys
import random

from mpmath import mp, mpf

from .schema import case, exact, flat, value, write

DIGITS = 34
sys.set_int_max_str_digits(0)


def zeros(n):
    return [[mpf(0)] * n for _ in range(n)]


def eye(n):
    return [[mpf(i == j) for j in range(n)] for i in range(n)]


def matmul(a, b):
    cols = list(zip(*b))
    return [[mp.fdot(r, c) for c in cols] for r in a]


def add(a, b):
    return [[x + y for x, y in zip(p, q)] for p, q in zip(a, b)]


def scaled(a, c):
    return [[c * x for x in r] for r in a]


def norm(a):
    return mp.sqrt(mp.fsum(x * x for r in a for x in r))


def expm(a, extra=0):
    """Taylor with scaling to norm 2^-extra/4; the precision is the caller's plus what squaring costs."""
    n = len(a)
    size = norm(a)
    if not size:
        return eye(n)
    s = max(0, int(mp.ceil(mp.log(size, 2))) + 2 + extra)
    # Cancellation in the squarings and entries of very different size are paid with digits.
    with mp.workprec(mp.prec + 4 * s + 64):
        x = scaled(a, mpf(2) ** -s)
        total, term, k = eye(n), eye(n), 0
        while True:
            k += 1
            term = scaled(matmul(term, x), mpf(1) / k)
            total = add(total, term)
            if norm(term) < mpf(2) ** -(mp.prec + 8) and k > 2:
                break
        for _ in range(s):
            total = matmul(total, total)
        return total


def frechet(a, e):
    n = len(a)
    block = [list(r) + list(q) for r, q in zip(a, e)] + [[mpf(0)] * n + list(r) for r in a]
    return [r[n:] for r in expm(block)[:n]]


def spectral(columns):
    """2-norm of the matrix with these columns, by power iteration."""
    m = len(columns)
    x = [mpf(1) + mpf(i % 7) / 8 for i in range(m)]
    s = mpf(0)
    for _ in range(60):
        y = [mp.fdot(x, c) for c in zip(*columns)]
        x = [mp.fdot(c, y) for c in columns]
        new = mp.sqrt(mp.sqrt(mp.fsum(t * t for t in x)))
        size = mp.sqrt(mp.fsum(t * t for t in x))
        if not size:
            return mpf(0)
        x = [t / size for t in x]
        if abs(new - s) < mpf("1e-4") * new:
            break
        s = new
    return mp.sqrt(size)


def conditions(a, g):
    n = len(a)
    size = norm(g)
    if n > 8 or not size:
        return None, None
    with mp.workdps(40):
        columns = []
        for j in range(n):
            for i in range(n):
                e = zeros(n)
                e[i][j] = mpf(1)
                columns.append([x for r in frechet(a, e) for x in r])
        weights = [abs(a[i][j]) for j in range(n) for i in range(n)]
        mixed = [mp.fsum(w * abs(c[k]) for w, c in zip(weights, columns)) for k in range(n * n)]
        return (spectral(columns) * norm(a) / size,
                mp.sqrt(mp.fsum(x * x for x in mixed)) / size)


# ---------------------------------------------------------------- families

def full(rows):
    return [[float(x) for x in r] for r in rows]


def so(rng, n, size):
    a = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i):
            a[i][j] = rng.gauss(0, 1)
            a[j][i] = -a[i][j]
    return rescale(a, size)


def rescale(a, size):
    """To the Frobenius norm size*sqrt(2), which on so(3) is |u| = size."""
    f = size * math.sqrt(2) / math.sqrt(sum(x * x for r in a for x in r))
    return [[f * x for x in r] for r in a]


def sp(rng, n, size, compact=False):
    m = n // 2
    a = [[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)]
    for i in range(m):
        for j in range(m):
            a[m + j][m + i] = -a[i][j]
            if j < i:
                a[i][m + j], a[m + i][j] = a[j][m + i], a[m + j][i]
    if compact:
        a = [[(a[i][j] - a[j][i]) / 2 for j in range(n)] for i in range(n)]
    return rescale(a, size)


def lorentz(rng, p, q, size):
    n = p + q
    a = so(rng, n, 1.0)
    for i in range(p):
        for j in range(p, n):
            a[i][j] = a[j][i]
    return rescale(a, size)


def planes(*angles):
    n = 2 * len(angles)
    a = [[0.0] * n for _ in range(n)]
    for k, x in enumerate(angles):
        a[2 * k][2 * k + 1], a[2 * k + 1][2 * k] = -x, x
    return a


def jordan(n, x):
    return [[x if i == j else float(j == i + 1) for j in range(n)] for i in range(n)]


def frank(n):
    return [[float(n - max(i, j)) if j >= i - 1 else 0.0 for j in range(n)] for i in range(n)]


def grcar(n):
    return [[-1.0 if i == j + 1 else float(0 <= j - i <= 3) for j in range(n)] for i in range(n)]


def lesp(n):
    return [[-(2.0 * i + 5) if i == j else i + 1.0 + 1 if j == i + 1 else 1 / (j + 2.0) if i == j + 1 else 0.0
             for j in range(n)] for i in range(n)]


def hilbert(n):
    return [[1 / (i + j + 1.0) for j in range(n)] for i in range(n)]


def cases():
    """(id, structure, u)."""
    rng = random.Random(11)
    g = "general"
    yield "zero1", g, full([[0]])
    yield "zero2", g, full([[0, 0], [0, 0]])
    yield "zero5", g, [[0.0] * 5 for _ in range(5)]
    for x in (0.5, 709.78, -745.0, -1e4):
        yield f"one_{x:g}", g, [[x]]
    yield "tiny_1e-300", g, full([[1e-300, 2e-300], [-3e-300, 1e-301]])
    yield "subnormal", g, full([[0, 5e-324], [1e-310, 0]])
    yield "so3_1e-160", "so", so(rng, 3, 1e-160)
    yield "so3_1e-300", "so", so(rng, 3, 1e-300)
    # Moler & Van Loan; Ward; Higham's gallery
    yield "mvl_49", g, full([[-49, 24], [-64, 31]])
    yield "ward_1", g, full([[4, 2, 0], [1, 4, 1], [1, 1, 4]])
    yield "ward_2", g, full([[29.87942128909879, 0.7815750847907159, -2.289519314033932],
                             [0.7815750847907159, 25.72656945571064, 8.680737820540137],
                             [-2.289519314033932, 8.680737820540137, 34.39400925519054]])
    yield "ward_3", g, full([[-131, 19, 18], [-390, 56, 54], [-387, 57, 52]])
    ward4 = [[float(j == i + 1) for j in range(10)] for i in range(10)]
    ward4[9][0] = 1e-10
    yield "ward_4", g, ward4
    yield "gl2_int", g, full([[1, 2], [3, 4]])
    yield "hilb6", g, hilbert(6)
    yield "jordan8", g, jordan(8, -1.0)
    yield "jordan8_up", g, [list(r) for r in zip(*jordan(8, 0.7))]
    yield "frank8", g, frank(8)
    yield "grcar12", g, grcar(12)
    yield "lesp8", g, lesp(8)
    # overscaling (Kenney & Laub; Dieci & Papini; Al-Mohy & Higham)
    yield "naive_a_1e6", g, full([[1, 1e6], [0, -1]])
    for x in (1e8, 1e12, 1e15):
        yield f"overscale_{x:g}", g, full([[0.1, x, 0], [0, 0.2, 0.5], [0, 0, -0.3]])
    yield "overscale_lower_1e12", g, full([[0.1, 0, 0], [1e12, 0.2, 0], [0.5, 1.0, -0.3]])
    yield "dieci_papini", g, full([[1, 1e6, 0, 0], [0, 1, 1e6, 0], [0, 0, 1, 1e6], [0, 0, 0, 1]])
    yield "beyond_overscale_full_1e6", g, full([[1e6 + 1, 1e6], [-1e6, 1 - 1e6]])
    yield "nilpotent6_1e3", g, [[1e3 if j > i else 0.0 for j in range(6)] for i in range(6)]
    yield "nilpotent4_1e60", g, [[1e60 if j == i + 1 else 0.0 for j in range(4)] for i in range(4)]
    # scaling
    yield "moler_balancing", g, full([[0, 1e-8, 0], [-(2e10 + 4e8 / 6), -3, 2e10], [200 / 3, 0, -200 / 3]])
    yield "mixed_1e-200_1e200", g, full([[0.5, 1e-200], [1e200, -0.5]])
    yield "mixed3", g, full([[0.1, 1e-90, 2e-150], [1e90, -0.2, 1e-60], [3e150, 2e60, 0.3]])
    for k in (40, 100):
        # so(M), M = diag(1, 1, 2^-k): u = M^-1 W with W skew
        w = so(rng, 3, 1.0)
        yield f"gM_near_singular_2^-{k}", g, [w[0], w[1], [x * 2.0 ** k for x in w[2]]]
    # a small scale that squaring loses
    yield "stiff_nonnormal", g, full([[-1e6, 1e6], [0, -1]])
    yield "stiff_nonnormal3", g, full([[-1e5, 1e5, 3], [0, -1, 1e3], [0, 0, -1e-2]])
    yield "stiff_lower", g, full([[-1, 0], [1e6, -1e6]])
    yield "beyond_stiff_full", g, full([[-1000, 1000], [1, -2]])
    yield "beyond_chain", g, full([[-2, 2, 0], [1e3, -1e3 - 1e-3, 1e-3], [0, 1e-6, -1e-6]])
    yield "neg_huge", g, full([[-2e3, 1], [0.5, -3e3]])
    yield "trace_600", g, full([[600, 1], [-2, 601]])
    yield "trace_-600", g, full([[-600, 3], [-2, -601]])
    # so(n)
    for n in (2, 3, 4, 5, 8, 12, 16, 17, 20, 30):
        for size in (1e-8, 0.01, 0.2, 1.0, 6.0, 1e3, 1e8):
            if n <= 8 or size in (0.2, 6.0, 1e8):
                yield f"so{n}_{size:g}", "so", so(rng, n, size)
    pi = math.pi
    for name, angles in (("isoclinic", (2.0, 2.0)), ("near_isoclinic", (2.0, 2.0 + 1e-9)), ("pi_pi", (pi, pi)),
                         ("pi_0", (pi, 0.0)), ("scales", (1e5, 1e-10)), ("rank2", (2.5, 0.0)), ("pi_3.2", (pi, 3.2))):
        yield f"so4_{name}", "so", planes(*angles)
    for x in (1e6, 1e12, 1e15 / 4):
        yield f"so3_{x:g}", "so", so(rng, 3, x)
        yield f"so6_{x:g}", "so", so(rng, 6, x)
    # sp(2m) and other forms
    yield "sp2_hyp_300", g, full([[180, 240], [240, -180]])
    yield "sp2_shear_1e8", g, full([[0, 1e8], [0, 0]])
    yield "sp2_stiff_1e8", g, full([[0, 1], [-1e8, 0]])
    yield "sp4_krein", g, full([[0, 1, 1, 0], [-1, 0, 0, 1], [0, 0, 0, 1], [0, 0, -1, 0]])
    for n in (2, 4, 8, 16, 30):
        for size in (0.03, 1.0, 20.0):
            yield f"sp{n}_{size:g}", g, sp(rng, n, size)
    yield "sp6_elliptic_1e3", g, sp(rng, 6, 1e3, True)
    for p, q in ((3, 1), (2, 2), (3, 3)):
        for size in (0.5, 8.0):
            yield f"so{p}{q}_{size:g}", g, lorentz(rng, p, q, size)
    for n in (3, 5, 6, 8, 16, 20):
        for size in (1e-3, 0.04, 0.5, 3.0, 12.0, 100.0):
            if n <= 8 or size in (0.5, 12.0):
                yield f"gl{n}_{size:g}", g, rescale([[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)], size)


def text(x):
    return mp.nstr(x, DIGITS) if abs(x) >= mpf("1e-400") else "0"


def main():
    out, worst = [], (mpf(0), None)
    for ident, structure, uf in cases():
        n = len(uf)
        u = [[mpf(x) for x in r] for r in uf]
        mp.dps = 60
        size = float(norm(u))
        if 1 < size:
            mp.dps += int(2 * math.log10(size)) + int(min(2 * size, 100))
        g = expm(u)
        with mp.workdps(mp.dps + 40):
            other = expm(u, extra=3)
            gap = norm(add(g, scaled(other, -1))) / norm(other) if norm(other) else mpf(0)
        assert gap < mpf(10) ** -40, (ident, gap)
        worst = max(worst, (gap, ident), key=lambda x: x[0])
        cond, mixed = conditions(u, g)
        short = lambda x: None if x is None else mp.nstr(x, 3)
        exp = value([text(x) for x in flat(g)], cond=short(cond), mixed=short(mixed))
        out.append(case(ident, "so" if structure == "so" else "gl", n, {"u": exact(flat(uf))}, {"exp": exp}))
        print(ident, mp.nstr(gap, 3), short(cond), short(mixed), flush=True)
    write("expm", "exp of hard matrices.", out)
    print("worst disagreement", mp.nstr(worst[0], 3), worst[1])
