"""Reference values of the hard cases that the other files do not hold: writes hard.json.

Conventions as in maps.py (its functions are used); inputs are doubles (repr), results have 30
digits, matrices row-major.

series_*: the cut Baker series S_q = sum_{k<=q} B_k/k! ad_u^k v in rational arithmetic.
    scale  sum_{k<=q} |B_k/k!| |ad_u^k v|, Frobenius: rounding is measured against it
    rest   |S_inf - S_q|, the series summed to 1e-40; left out where it does not converge
exp_*: exp on so(3) from the least subnormal to the largest double.
dexpinv: the exact map where it is hard: angles at pi and at 3.9 pi on so(3) (closed form),
    real spreads of 8, 30, 40 (diagonal u: phi(u_j - u_k) v_jk), nilpotent u (rational, finite sum).
    cond as in maps.py for so(3); elsewhere
    (max|phi| + |u| max|phi'|) |v|/|w|.
cay: eigenvalues of u next to 2; cond is that of 1 - u/2 in the Frobenius norm.
"""
import math
import random
from fractions import Fraction

from mpmath import mp, mpf

from .maps import (add, commutator, condition3, dexpinv3, digits, exp3, eye, gl_element, hat, inverse,
                   lorentz_element, matmul, norm, so_element, sp_element, spectral)
from .schema import case, exact, flat, value, write

mp.dps = 60
QS = list(range(1, 13)) + [20]


def bernoulli(count):
    b = [Fraction(1)]
    for m in range(1, count):
        b.append(-sum(Fraction(math.comb(m + 1, k)) * b[k] for k in range(m)) / (m + 1))
    return b


BAKER = [b / math.factorial(k) for k, b in enumerate(bernoulli(140))]


def rational(a):
    return [[Fraction(x) for x in r] for r in a]


def real(a):
    """Fractions to 60 digits."""
    return [[mpf(x.numerator) / x.denominator for x in r] for r in a]


def text(a, count=30):
    return [mp.nstr(mp.re(x), count) for x in flat(a)]


def of_size(a, size):
    s = size / spectral(a)
    return [[x * s for x in r] for r in a]


def symplectic(a):
    """The lower right block is -A^T exactly after any scaling."""
    m = len(a) // 2
    for i in range(m):
        for j in range(m):
            a[m + j][m + i] = -a[i][j]
    return a


def series_cases():
    rng = random.Random(31)
    yield "so3_0.5", "so", of_size(so_element(rng, 3), 0.5), so_element(rng, 3)
    yield "so3_3", "so", of_size(so_element(rng, 3), 3.0), so_element(rng, 3)
    yield "so5_2", "so", of_size(so_element(rng, 5), 2.0), so_element(rng, 5)
    yield "sp4_1", "sp", symplectic(of_size(sp_element(rng, 4), 1.0)), sp_element(rng, 4)
    yield "gl3_0.1", "gl", of_size(gl_element(rng, 3), 0.1), gl_element(rng, 3)
    yield "gl3_8", "gl", of_size(gl_element(rng, 3), 8.0), gl_element(rng, 3)
    yield "lorentz4_2", "lorentz", of_size(lorentz_element(rng, 4), 2.0), lorentz_element(rng, 4)


def make_series():
    out = []
    for ident, kind, uf, vf in series_cases():
        u, v = rational(uf), rational(vf)
        ad, total, scale, sums = v, v, norm(real(v)), {}
        for k in range(1, max(QS) + 1):
            ad = commutator(u, ad)
            total, scale = add(total, ad, BAKER[k]), scale + abs(float(BAKER[k])) * norm(real(ad))
            if k in QS:
                sums[k] = (total, scale)
        # To the end in 60 digits, where the series converges.
        um, term, limit = real(u), real(v), real(v)
        for k in range(1, len(BAKER)):
            term = commutator(um, term)
            limit = add(limit, term, mpf(BAKER[k].numerator) / BAKER[k].denominator)
        last = norm(term) * abs(mpf(BAKER[-2].numerator) / BAKER[-2].denominator)
        converged = last < mpf(10) ** -20
        rest = lambda s: digits(norm(add(limit, real(s), -1)), 6) if converged else None
        outputs = {f"dexpinv_{q}": value(text(real(s)), scale=digits(scale, 6), rest=rest(s))
                   for q, (s, scale) in sums.items()}
        inputs = {"u": exact(flat(uf)), "v": exact(flat(vf))}
        out.append(case("series_" + ident, kind, len(uf), inputs, outputs))
    return out


def make_exp3():
    sizes = [5e-324, 1e-320, 1e-308, 1e-300, 1e-160, 1e-154, 1e-20, 1e-8] + [10.0 ** k for k in range(6, 17)]
    sizes += [1e20, 1e50, 1e100, 9.9e149, 1.1e150, 1e160, 1e200, 1e300, 1.7e308]
    out = []
    for size in sizes:
        for d in ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.48, -0.6, 0.64)):
            u = [size * x for x in d]
            with mp.workdps(1000):
                r = exp3([mpf(x) for x in u])
            out.append(case(f"exp_{len(out)}", "so", 3, {"u": exact(u)}, {"exp": value(text(r))}))
    return out


def phi(z):
    return z / mp.expm1(z) if z else mpf(1)


def make_dexpinv():
    rng, out = random.Random(32), []

    def add_case(ident, kind, uf, vf, w, cond):
        inputs = {"u": exact(flat(uf)), "v": exact(flat(vf))}
        out.append(case(ident, kind, len(uf), inputs, {"dexpinv": value(text(w), cond=digits(mpf(cond), 3))}))

    for ident, size in (("so3_3", 3.0), ("so3_pi", math.pi), ("so3_3.9pi", 3.9 * math.pi), ("so3_10", 10.0),
                        ("so3_2pi+1e-3", 2 * math.pi + 1e-3)):
        uf = [size * x for x in (0.48, -0.6, 0.64)]
        vf = [rng.gauss(0, 1) for _ in range(3)]
        u, v = [mpf(x) for x in uf], [mpf(x) for x in vf]
        with mp.workdps(200):
            w = dexpinv3(u, v)
            cond = max(condition3(dexpinv3, u, v))
        add_case(ident, "so", hat(uf), hat(vf), hat(w), cond)
    for spread in (8.0, 30.0, 40.0):
        for kind, d in (("sp", [spread / 2, -spread / 2]), ("gl", [spread, 0.5, 0.0])):
            n = len(d)
            uf = [[d[i] if i == j else 0.0 for j in range(n)] for i in range(n)]
            vf = sp_element(rng, n) if kind == "sp" else gl_element(rng, n)
            z = [[mpf(d[i]) - mpf(d[j]) for j in range(n)] for i in range(n)]
            w = [[phi(z[i][j]) * mpf(vf[i][j]) for j in range(n)] for i in range(n)]
            top = max(phi(x) for x in flat(z))
            add_case(f"{kind}{n}_spread_{spread:g}", kind, uf, vf, w, (top + norm(uf)) * norm(vf) / norm(w))
    nilpotent = [[0.0, 0.0, 3.0, 1.5], [0.0, 0.0, 1.5, -2.25], [0.0] * 4, [0.0] * 4]
    jordan = [[0.7, 5.0, -3.0], [0.0, 0.7, 9.0], [0.0, 0.0, 0.7]]
    for ident, kind, uf, vf in (("sp4_nilpotent", "sp", nilpotent, sp_element(rng, 4)),
                                ("gl3_defective", "gl", jordan, gl_element(rng, 3))):
        # Without the multiple of 1, which ad does not see; ad^5 = 0.
        u, v = rational(uf), rational(vf)
        ad, w = v, v
        for k in range(1, 8):
            ad = commutator(u, ad)
            w = add(w, ad, BAKER[k])
        assert not any(flat(ad)), ident
        add_case(ident, kind, uf, vf, real(w), norm(uf) ** 4 * norm(vf) / norm(real(w)))
    return out


def make_cay():
    out = []
    x = 2 - 1e-10
    sp2 = [[x, 0.25], [0.0, -x]]
    p, q = [[1, 1, 0], [0, 1, 1], [0, 0, 1]], [[1, -1, 1], [0, 1, -1], [0, 0, 1]]
    for ident, kind, uf in [("cay_near_singular_sp2", "sp", sp2)] + [
            (f"cay_near_singular_gl3_{gap:g}", "gl",
             matmul(matmul(p, [[2.0, -gap, 0.0], [gap, 2.0, 0.0], [0.0, 0.0, 1.0]]), q)) for gap in (1e-3, 1e-6, 1e-10)]:
        n, u = len(uf), [[mpf(x) for x in r] for r in uf]
        minus, plus = add(eye(n), u, -mpf(1) / 2), add(eye(n), u, mpf(1) / 2)
        g = matmul(inverse(minus), plus)
        assert norm(add(matmul(minus, g), plus, -1)) < mpf(10) ** -40
        cond = digits(norm(minus) * norm(inverse(minus)), 3)
        out.append(case(ident, kind, n, {"u": exact(flat(uf))}, {"cay": value(text(g), cond=cond)}))
    return out


def main():
    write("hard", "Hard cases by number: cut series, exp on so(3) at every size, dexp^-1 far out, cay next to its "
          "pole.", make_series() + make_exp3() + make_dexpinv() + make_cay())
