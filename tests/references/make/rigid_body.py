"""Reference solutions of the torque-free rigid body: writes rigid_body.json.

Equations.  Body momentum m' = m x (J^-1 m), attitude g (body to space)
g' = hat(w) g with w = g J^-1 m, that is g' = g hat(J^-1 m).  g m is constant.

Inputs are IEEE doubles, written with repr; all references belong to the exact
values of these doubles and are written with 36 significant digits.

(a) Closed form.  Sort J_a <= J_b <= J_c, L = |m|, and (exactly, in rationals)
    d_i = L^2 - 2 E J_i = sum_j m_j^2 (1 - J_i/J_j).
(x,y,z) = (a,b,c) if d_b > 0 or J_a = J_b, else (c,b,a):
    m_x = A cn, m_y = s_y B sn, m_z = s_z C dn   at  tau = lam t + tau0,
    A^2 = J_x d_z/(J_x-J_z), B^2 = J_y d_z/(J_y-J_z), C^2 = J_z d_x/(J_z-J_x),
    lam^2 = (J_z-J_y) d_x/(J_x J_y J_z), k'^2 = (J_z-J_x) d_y/((J_z-J_y) d_x),
    s_z = sign m_z(0), s_y = sign(s_z (1/J_k - 1/J_j)) with (y,j,k) cyclic.
sn, cn, dn come from the arithmetic-geometric mean started with k'.
Attitude: g = g0 T(m0) R_z(phi) T(m)^T, T(m) = [x, y, z] with z = m/L,
x ~ e_x - (e_x.z) z, y = z x x, and
    phi = L t/J_z + L (1/J_y - 1/J_z) (B/C)^2/lam (D(tau) - D(tau0)),
    D(tau) = int_0^tau sn^2/(1 - n sn^2), n = -(A/C)^2,
by Carlson's R_J (elliptic integral of the third kind).  On the separatrix
(d_b = 0) sn = tanh; where m x J^-1 m = 0 the motion is a steady rotation.

(b) Independent check: Taylor series of order 70 and more for m and a unit quaternion
in fixed-point integers of 240 bits and more with a variable step (no elliptic
function), for all cases of moderate length. Small components of m need more bits:
once to be there, and once to grow.
(c) All cases: the closed form restarted from its own state at t/3.
The script asserts that (a) agrees with (b) and with (c) to 1e-33 relative to |m|
and to |g|, that g is orthogonal and that g m = g0 m0, and prints the worst
disagreement.

ulp: largest change (Euclidean, Frobenius) of m, g when one nonzero input
(J, m, t) moves by one ulp, by central differences at high precision.

The number (default 4000) decides only which cases get check (b): all but the four
longest.  The data do not depend on it.
"""
import math
import random
from fractions import Fraction
from operator import mul

from mpmath import mp, mpf

from .schema import case, check, exact, flat, value, write

DIGITS = 36      # significant digits written
GUARD = 70       # working digits beyond those lost to small parameters
MAX_STEPS = 4000
MAX_BITS = 660


def real(q):
    """mpf of a rational at the working precision."""
    return mpf(q.numerator) / mpf(q.denominator)


def rational(x):
    """Exact rational value of an mpf."""
    if not x:
        return Fraction(0)
    sign, man, exp, _ = x._mpf_
    value = Fraction(int(man)) * Fraction(2) ** exp
    return -value if sign else value


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def matmul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transpose(a):
    return [list(r) for r in zip(*a)]


def norm(entries):
    return mp.sqrt(sum(x * x for x in entries))


def steady(w, t):
    """exp(t hat(w))."""
    rate = norm(w)
    if not rate:
        return mp.eye(3).tolist()
    s, c = mp.sin(rate * t), mp.cos(rate * t)
    n = [x / rate for x in w]
    hat = [[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]]
    return [[(c if i == j else 0) + s * hat[i][j] + (1 - c) * n[i] * n[j] for j in range(3)]
            for i in range(3)]


def jacobi(u, kc):
    """sn, cn, dn of u with complementary modulus kc > 0 (descending Landen)."""
    a, b, steps = mpf(1), kc, []
    while a - b > mp.eps * a * 4:
        a, b, c = (a + b) / 2, mp.sqrt(a * b), (a - b) / 2
        steps.append((a, c))
    phi = mpf(2) ** len(steps) * a * u
    for a, c in reversed(steps):
        phi = (phi + mp.asin(c / a * mp.sin(phi))) / 2
    s, c = mp.sin(phi), mp.cos(phi)
    return s, c, mp.sqrt(c * c + (kc * s) ** 2)


def frame(m, length, ax):
    """Triad with third vector m/length, first vector the part of e_ax normal to it."""
    z = [c / length for c in m]
    i, j = [q for q in range(3) if q != ax]
    s2 = z[i] ** 2 + z[j] ** 2            # 1 - z_ax^2 without cancellation
    s = mp.sqrt(s2)
    x = [-z[ax] * c / s for c in z]
    x[ax] = s
    return transpose([x, cross(z, x), z])


def closed(J, m0, t):
    """m(t), g(t) with g(0) = 1 for rationals J, m0, t (closed form)."""
    if not any(cross(m0, [a / b for a, b in zip(m0, J)])):
        m = [real(x) for x in m0]
        return m, steady([real(x / y) for x, y in zip(m0, J)], real(t))
    a, b, c = sorted(range(3), key=lambda i: J[i])
    L2 = dot(m0, m0)
    d = [sum(m0[j] ** 2 * (1 - J[i] / J[j]) for j in range(3)) for i in range(3)]
    x, y, z = (a, b, c) if d[b] > 0 or J[a] == J[b] else (c, b, a)
    A2 = J[x] * d[z] / (J[x] - J[z])
    B2 = J[y] * d[z] / (J[y] - J[z])
    C2 = J[z] * d[x] / (J[z] - J[x])
    lam2 = (J[z] - J[y]) * d[x] / (J[x] * J[y] * J[z])
    kc2 = (J[z] - J[x]) * d[y] / ((J[z] - J[y]) * d[x])
    angle = real(L2) ** 0.5 * abs(real(t)) / min(map(real, J))
    small = [abs(q) for q in (kc2, 1 - kc2, A2 / L2, C2 / L2, 1 - J[a] / J[b], 1 - J[b] / J[c]) if q]
    lost = sum(abs(mp.log10(real(q))) for q in (min(small), max(map(abs, m0)) / min(
        abs(v) for v in m0 if v))) + mp.log10(angle + 1)
    with mp.workdps(GUARD + int(lost)):
        A, B, C, lam, kc = [mp.sqrt(real(q)) for q in (A2, B2, C2, lam2, kc2)]
        L, t_ = mp.sqrt(real(L2)), real(t)
        sz = 1 if m0[z] > 0 else -1
        j, k = (y + 1) % 3, (y + 2) % 3
        sy = sz * (1 if 1 / J[k] > 1 / J[j] else -1)
        n = -real(A2 / C2)
        start = [real(q) for q in m0]
        sn0, cn0 = sy * start[y] / B, start[x] / A
        if kc:
            K = mp.pi / (2 * mp.agm(1, kc))
            F = sn0 * mp.elliprf(cn0 ** 2, (start[z] / C) ** 2, 1)
            tau0 = F if cn0 >= 0 else (2 * K - F if sn0 >= 0 else -2 * K - F)
            third = lambda s, c, dn: s ** 3 * mp.elliprj(c * c, dn * dn, 1, 1 - n * s * s) / 3
            full = third(mpf(1), mpf(0), kc)

            def at(tau):
                p = int(mp.floor((tau + K) / (2 * K)))
                s, c, dn = jacobi(tau - 2 * p * K, kc)
                sign = -1 if p % 2 else 1
                return sign * s, sign * c, dn, 2 * p * full + third(s, c, dn)
        else:
            sign_x = 1 if cn0 > 0 else -1    # cn -> +-sech on the separatrix
            sy, A = sy * sign_x, A * sign_x
            tau0 = mp.asinh(sn0 / abs(cn0)) * sign_x
            w = mp.sqrt(-n)

            def at(tau):
                s, c = mp.tanh(tau), mp.sech(tau)
                return s, c, c, (tau - mp.atan(w * s) / w) / (1 - n)
        s, c, dn, D1 = at(lam * t_ + tau0)
        D0 = at(tau0)[3]
        m = [None] * 3
        m[x], m[y], m[z] = A * c, sy * B * s, sz * C * dn
        phi = L * t_ / real(J[z]) + L * real(1 / J[y] - 1 / J[z]) * real(B2 / C2) / lam * (D1 - D0)
        R = [[mp.cos(phi), -mp.sin(phi), 0], [mp.sin(phi), mp.cos(phi), 0], [0, 0, 1]]
        g = matmul(matmul(frame(start, L, x), R), transpose(frame(m, L, x)))
        return m, g


def taylor(J, m0, t):
    """m(t), g(t) with g(0) = 1 by power series in fixed-point integers; None if too long."""
    L = mp.sqrt(real(dot(m0, m0)))
    if not L or not t:
        return [real(q) for q in m0], mp.eye(3).tolist()
    least = int(min(0, *(mp.log(real(abs(q)) / L, 2) for q in m0 if q)))
    grows = int(1.5 * L * abs(real(t)) / real(min(J)))
    bits = 240 - 2 * least if least < -60 and least + grows > -120 else 240
    if bits > MAX_BITS:
        return None
    order = 7 * bits // 24
    one = 1 << bits
    fixed = lambda v: int(mp.nint(mp.ldexp(v, bits)))
    scale = min(J)
    inv = [fixed(real(scale / q)) for q in J]
    m = [fixed(real(q) / L) for q in m0]
    q = [one, 0, 0, 0]
    end = fixed(L * abs(real(t)) / real(scale))
    back = t < 0
    if end > 12 * MAX_STEPS * one:
        return None
    now, h, steps = 0, one, 0
    tol = mpf(2) ** (40 - bits)      # well above the rounding of the coefficients
    while now < end:
        steps += 1
        if steps > MAX_STEPS:
            return None
        M = [[v] for v in m]
        W = [[(v * w) >> bits] for v, w in zip(m, inv)]
        Q = [[v] for v in q]
        hs = -h if back else h
        for k in range(order):
            rM = [v[::-1] for v in M]
            rW = [v[::-1] for v in W]
            conv = lambda u, v: sum(map(mul, u, v))
            new_m = [conv(M[(i + 1) % 3], rW[(i + 2) % 3]) - conv(M[(i + 2) % 3], rW[(i + 1) % 3])
                     for i in range(3)]
            new_q = [-conv(Q[1], rW[0]) - conv(Q[2], rW[1]) - conv(Q[3], rW[2]),
                     conv(Q[0], rW[0]) + conv(Q[2], rW[2]) - conv(Q[3], rW[1]),
                     conv(Q[0], rW[1]) + conv(Q[3], rW[0]) - conv(Q[1], rW[2]),
                     conv(Q[0], rW[2]) + conv(Q[1], rW[1]) - conv(Q[2], rW[0])]
            for i in range(3):
                v = (new_m[i] >> bits) * hs // ((k + 1) << bits)
                M[i].append(v)
                W[i].append((v * inv[i]) >> bits)
            for i in range(4):
                Q[i].append((new_q[i] >> bits) * hs // ((k + 1) << (bits + 1)))
        last = max(max(abs(v[order]), abs(v[order - 1])) for v in M + Q)
        ratio = (tol / mp.ldexp(mpf(max(last, 1)), -bits)) ** (mpf(1) / order)
        sigma = min(one, fixed(ratio * mpf('0.95')))
        if now + ((sigma * h) >> bits) >= end:
            sigma = ((end - now) << bits) // h
            now = end
        else:
            now += (sigma * h) >> bits

        def value(v):
            acc = 0
            for coef in reversed(v):
                acc = ((acc * sigma) >> bits) + coef
            return acc
        m, q = [value(v) for v in M], [value(v) for v in Q]
        h = (h * fixed(min(ratio, 2) * mpf('0.95'))) >> bits
    m = [mp.ldexp(mpf(v), -bits) * L for v in m]
    a, b, c, d = [mp.ldexp(mpf(v), -bits) for v in q]
    g = [[a*a + b*b - c*c - d*d, 2*(b*c - a*d), 2*(b*d + a*c)],
         [2*(b*c + a*d), a*a - b*b + c*c - d*d, 2*(c*d - a*b)],
         [2*(b*d - a*c), 2*(c*d + a*b), a*a - b*b - c*c + d*d]]
    return m, g


def sensitivity(J, m0, t):
    """Largest |d m|, |d g| for a change of one input by one ulp."""
    inputs = list(J) + list(m0) + [t]
    best = [mpf(0), mpf(0)]
    for i, value in enumerate(inputs):
        if value:
            step = Fraction(math.ulp(float(value))) / 2 ** 20
            ends = []
            for sign in (1, -1):
                moved = inputs[:i] + [value + sign * step] + inputs[i + 1:]
                ends.append(closed(moved[:3], moved[3:6], moved[6]))
            (mp_, gp), (mm, gm) = ends
            change = (norm(p - q for p, q in zip(mp_, mm)), norm(p - q for p, q in zip(flat(gp), flat(gm))))
            best = [max(p, q * 2 ** 19) for p, q in zip(best, change)]
    return [v if v > mpf(10) ** -50 * (scale or 1) else mpf(0)
            for v, scale in zip(best, (norm(real(q) for q in m0), 1))]


IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
CYCLE = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
QUARTER = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
SIGNED = [0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def cases():
    """(id, inertia, momentum, t[, attitude0])"""
    s18 = 1.0 / 18.0
    for t in (0.05, 1.0, 10.0, 400.0):
        yield f"example1_t{t:g}", (1, 2, 3), (0.2, 0, 3), t
        yield f"example2_t{t:g}", (1, 1, 2), (0.2, 0, 2), t
    for t in (0.004, 0.05, 1.0, 10.0, 400.0):
        yield f"example3_t{t:g}", (1, 0.25, s18), (0, 2.75, 2.75), t
    for t in (0.05, 1.0, 10.0, 400.0):
        yield f"example3_printed_t{t:g}", (1, 4, 18), (0, 2.75, 2.75), t
    orders = [((1, 2, 3), (0.7, -0.4, 1.9)), ((1, 3, 2), (-1.3, 0.2, 0.5)), ((2, 1, 3), (0.3, -1.4, -0.6)),
              ((2, 3, 1), (-0.5, -1.1, 0.9)), ((3, 1, 2), (1.6, 0.35, 0.8)), ((3, 2, 1), (-0.25, 0.6, -1.7))]
    for i, (J, m) in enumerate(orders):
        name = "axes_" + "".join(map(str, J))
        yield name + "_t7.3", J, m, 7.3
        yield name + "_swapped_t21", J, (-m[2], m[0], m[1]), 21.0, (CYCLE, QUARTER, SIGNED)[i % 3]
    r3 = math.sqrt(3.0)
    for exponent in (6, 12, 14):
        for sign, word in ((1, "above"), (-1, "below")):
            m3 = r3 * (1.0 + sign * 10.0 ** -exponent)
            times = {6: (1.0, 50.0, 100.0, 200.0), 12: (50.0, 100.0, 200.0), 14: (50.0, 100.0)}[exponent]
            for t in times if sign > 0 else times[-2:-1]:
                yield f"separatrix_{word}_1e-{exponent}_t{t:g}", (1, 2, 3), (1.0, 0.5, m3), t
    yield "separatrix_middle_start_1e-6_t50", (1, 2, 3), (1e-6, 1.0, 1e-6), 50.0
    yield "separatrix_middle_start_1e-12_t100", (3, 2, 1), (1e-12, -1.0, 2e-12), 100.0
    yield "separatrix_exact_t1", (1, 2, 2.25), (1, 0.5, 3), 1.0
    yield "separatrix_exact_t20", (1, 2, 2.25), (1, 0.5, 3), 20.0
    yield "separatrix_exact_signs_t20", (1, 2, 2.25), (-1, 0.5, 3), 20.0
    yield "separatrix_exact_permuted_t15", (2, 3.125, 1), (0.25, -2.5, -1.5), 15.0, CYCLE
    yield "separatrix_exact_permuted_t-15", (3.125, 2, 1), (-2.5, 0.25, -1.5), -15.0
    yield "middle_axis", (1, 2, 3), (0, 1.3, 0), 10.0
    yield "middle_axis_permuted", (2, 1, 3), (-1.3, 0, 0), 100.0, SIGNED
    yield "axis1", (1, 2, 3), (1.3, 0, 0), 10.0
    yield "axis3", (1, 2, 3), (0, 0, -1.3), 10.0
    for eps in (1e-9, 1e-160):
        for axis, word in enumerate(("axis1", "middle_axis", "axis3")):
            m = [eps, eps, eps]
            m[axis] = 1.3
            yield f"nearly_{word}_{eps:g}", (1, 2, 3), m, 10.0
    for exponent, t in ((60, 480.0), (122, 977.0), (130, 1040.0), (150, 2000.0), (200, 1610.0), (290, 2330.0)):
        small = 10.0 ** -exponent
        for number, (J, m) in enumerate((((1, 2, 3), (small, 1, small)), ((3, 1, 2), (-2 * small, small, -1)))):
            yield f"tiny_beside_middle_axis_1e-{exponent}_{number}", J, m, t * (1 + 1.3 * number)
    for eps in (1e-290, 1e-305):
        yield f"tiny_beside_axis3_{eps:g}", (1, 2, 3), (eps, 2 * eps, 1.3), 10.0
        yield f"tiny_beside_axis1_{eps:g}", (1, 2, 3), (1.3, eps, -eps), 10.0
    yield "nearly_symmetric_ab_1e-9_t100", (1, 1 + 1e-9, 2), (0.6, -0.8, 0.5), 100.0
    yield "nearly_symmetric_ab_1e-12_t100", (1, 1 + 1e-12, 2), (0.6, -0.8, 0.5), 100.0
    yield "nearly_symmetric_ab_1e-12_flat_t100", (1, 1 + 1e-12, 2), (0.6, -0.8, 1e-6), 100.0
    yield "nearly_symmetric_bc_1e-12_t100", (1, 2, 2 + 1e-12), (0.6, -0.8, 0.5), 100.0
    yield "nearly_symmetric_bc_1e-12_flat_t100", (1, 2, 2 + 1e-12), (1e-7, -0.8, 0.5), 100.0
    yield "symmetric_ab_t30", (1, 1, 2), (0.6, -0.8, 0.5), 30.0
    yield "symmetric_bc_t30", (1, 2, 2), (0.6, -0.8, 0.5), 30.0
    yield "symmetric_ac_t30", (2, 1, 2), (0.6, -0.8, 0.5), 30.0, QUARTER
    yield "symmetric_ab_mz0_t30", (1, 1, 2), (0.6, -0.8, 0), 30.0
    yield "symmetric_bc_mx0_t30", (1, 2, 2), (0, -0.8, 0.5), 30.0
    yield "nearly_spherical_1e-10_t100", (1, 1 + 1e-10, 1 - 1e-10), (0.6, -0.8, 0.5), 100.0
    yield "spherical_t10", (1.7, 1.7, 1.7), (0.6, -0.8, 0.5), 10.0
    yield "slender_t1", (1, 1000, 1000.5), (0.3, 1.0, -0.7), 1.0
    yield "slender_t1000", (1, 1000, 1000.5), (0.3, 1.0, -0.7), 1e3
    yield "spike_t1", (1, 1e6, 1.5e6), (0.01, 1.0, 2.0), 1.0
    yield "spike_t1000", (1, 1e6, 1.5e6), (0.01, 1.0, 2.0), 1e3
    for t in (1.0, 1e3, 1e5):
        yield f"extreme_inertia_t{t:g}", (1, 1e4, 1.0001e4), (0.2, 1.0, 0.5), t
    yield "momentum_zero", (1, 2, 3), (0, 0, 0), 5.0
    yield "momentum_zero_rotated", (1, 2, 3), (0, 0, 0), 5.0, CYCLE
    yield "momentum_1e-150", (1, 2, 3), (0.7e-150, -0.4e-150, 1.9e-150), 1e151
    yield "momentum_1e150", (1, 2, 3), (0.7e150, -0.4e150, 1.9e150), 1e-149
    yield "inertia_1e100", (1e100, 2e100, 3e100), (0.7, -0.4, 1.9), 1e101
    yield "inertia_1e-100", (1e-100, 2e-100, 3e-100), (0.7, -0.4, 1.9), 1e-99
    yield "fast_spin_t0.1", (1, 2, 3), (7e3, -4e3, 1.9e4), 0.1
    yield "fast_spin_example3_t0.1", (1, 0.25, s18), (600.0, -500.0, 400.0), 0.1
    yield "slow_spin_t3", (1, 2, 3), (0.7e-8, -0.4e-8, 1.9e-8), 3.0
    yield "slow_spin_t1e9", (1, 2, 3), (0.7e-8, -0.4e-8, 1.9e-8), 1e9
    yield "negative_t-5", (1, 2, 3), (0.7, -0.4, 1.9), -5.0
    yield "negative_t-60", (3, 1, 2), (-0.7, 1.4, 0.9), -60.0, SIGNED
    yield "t0", (1, 2, 3), (0.7, -0.4, 1.9), 0.0
    yield "t0_rotated", (1, 2, 3), (0.7, -0.4, 1.9), 0.0, CYCLE
    yield "tiny_t", (1, 2, 3), (0.7, -0.4, 1.9), 1e-20
    yield "long_t1e5", (1, 2, 3), (0.7, -0.4, 1.9), 1e5
    yield "long_other_side_t1e5", (1.3, 2.9, 2.1), (1.7, -0.4, 0.9), 1e5, QUARTER
    rng = random.Random(20)
    for i in range(15):
        J = [10 ** rng.uniform(-2, 2) for _ in range(3)]
        m = [rng.gauss(0, 1) for _ in range(3)]
        rate = max(abs(a / b) for a, b in zip(m, J))
        yield f"random_{i}", J, m, 10 ** rng.uniform(0, 2) / rate


def main():
    mp.dps = GUARD
    out, by_taylor, skipped = [], 0, []
    for ident, J, m, t, *g0 in cases():
        J, m, t = [float(v) for v in J], [float(v) for v in m], float(t)
        Jq, mq, tq = [Fraction(v) for v in J], [Fraction(v) for v in m], Fraction(t)
        g0 = g0[0] if g0 else None
        start = [[mpf(v) for v in (g0 or IDENTITY)[3 * i:3 * i + 3]] for i in range(3)]
        m1, g1 = closed(Jq, mq, tq)
        mnorm = norm(real(v) for v in mq) or mpf(1)

        def compare(what, m2, g2):
            check(what + " m", ident, norm(p - q for p, q in zip(m1, m2)) / mnorm)
            check(what + " g", ident, norm(p - q for p, q in zip(flat(g1), flat(g2))) / mp.sqrt(3))

        mid_m, mid_g = closed(Jq, mq, tq / 3)
        m2, g2 = closed(Jq, [rational(v) for v in mid_m], tq - tq / 3)
        compare("restart", m2, matmul(mid_g, g2))
        series = taylor(Jq, mq, tq)
        if series:
            compare("taylor", *series)
            by_taylor += 1
        else:
            skipped.append(ident)
        check("orthogonality", ident, norm(
            dot(a, b) - (i == j) for i, a in enumerate(g1) for j, b in enumerate(g1)))
        check("space momentum", ident, norm(dot(r, m1) - real(v) for r, v in zip(g1, mq)) / mnorm)
        sens_m, sens_g = sensitivity(Jq, mq, tq)
        energy = sum(a * a / b for a, b in zip(mq, Jq)) / 2
        check("energy", ident, abs(sum(a * a / real(b) for a, b in zip(m1, Jq)) / 2 - real(energy))
              / (real(energy) or 1))
        inputs = {"inertia": exact(J), "momentum": exact(m)}
        if g0:
            inputs["attitude0"] = exact(g0)
        inputs["t"] = exact([t])
        g1 = matmul(start, g1)
        text = lambda entries: [mp.nstr(v, DIGITS) for v in entries]
        out.append(case(ident, "so", 3, inputs, {
            "m": value(text(m1), ulp=mp.nstr(sens_m, 4)), "g": value(text(flat(g1)), ulp=mp.nstr(sens_g, 4)),
            "energy": value(text([real(energy)]))}))
    write("rigid_body", "The torque-free rigid body: m' = m x J^-1 m, g' = g hat(J^-1 m).", out)
    print(by_taylor, "cases also by Taylor series; not:", *skipped)
