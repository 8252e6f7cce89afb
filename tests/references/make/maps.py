"""Reference values of coordinate maps and their inverse differentials: writes maps.json.

Conventions.  Differentials are right-trivialised: d/de Psi(u + e v) = dPsi_u(v) Psi(u);
dPsi_u^-1 is the inverse of v -> dPsi_u(v).  so(3) is R^3 by hat(u) w = u x w.
Inputs are IEEE doubles written with repr; references belong to their exact values and
have 36 (so(3)) or 27 (matrices) significant digits.  null: undefined (see below), or
outside the range of doubles.

On so(3), formulas written out (a = |u|):
    exp       Rodrigues, 1 + sin(a)/a u^ + 2 sin^2(a/2)/a^2 u^^2
    dexpinv   v - u x v/2 + (1 - (a/2) cot(a/2))/a^2 u x (u x v)
    cay       (1 - u/2)^-1 (1 + u/2);     dcayinv  v - u x v/2 + (u.v) u/4
    ccsk123   exp(u1 e1) exp(u2 e2) exp(u3 e3);  ccsk321 the reversed product
    dccskinv  solution of [c1 c2 c3] x = v, c_i = (product of the factors left of i) e_i
Checked: every map against a matrix exponential by Taylor series with scaling and
squaring (cay: by solving the linear system), every inverse differential w by
    (Psi(u + h w) - Psi(u - h w))/(2h) Psi(u)^T = hat(v),
central differences at several hundred digits.

On matrices: so(n); sp(2m) with form [[0,1],[-1,0]],
u = [[A, B], [C, -A^T]]; gl(n); lorentz: so(3,1), form diag(1,1,1,-1).  u lies exactly
in the algebra.  ids of random u end in its spectral norm.
    exp       Taylor series with scaling and squaring; checked by Pade (mpmath) at other digits
    dexpinv   with u = V diag(l) V^-1: X = V^-1 v V, X_jk *= z/(e^z - 1), z = l_j - l_k;
              null if some z is within 1e-3 of 2 pi i k, k != 0.  Checked by the linear
              equation dexp_u(w) = sum_k ad_u^k w/(k+1)! = v and by central differences of exp
    cay, dcayinv = v - [u,v]/2 - u v u/4; null if u has an eigenvalue within 1e-3 of 2.
              Checked by 2 (1-u/2)^-1 - 1 and by central differences

Condition numbers (3 digits).  cond_exp = |L| |u|/|exp u|, L the Frechet derivative in
the Frobenius norm.  cond_dX = (|D_u w| |u| + |D_v w| |v|)/|w| for w = dX_u^-1(v), operator
norms 2-norm (so3, from central differences) or Frobenius (general, from divided
differences in the eigenbasis by power iteration): inputs moved by relative eps change
the result by at most about cond eps |w|.  Perturbations of u are not restricted to the
algebra there.
"""
import cmath
import math
import random

from mpmath import mp, mpf

from .schema import case, check, exact, flat, value, write

DIGITS3, DIGITS = 36, 27


def matmul(a, b):
    cols = list(zip(*b))
    return [[sum(map(lambda x, y: x * y, r, c)) for c in cols] for r in a]


def add(a, b, s=1):
    return [[x + s * y for x, y in zip(p, q)] for p, q in zip(a, b)]


def scaled(a, s):
    return [[x * s for x in r] for r in a]


def eye(n):
    return [[int(i == j) for j in range(n)] for i in range(n)]


def transpose(a):
    return [list(r) for r in zip(*a)]


def commutator(a, b):
    return add(matmul(a, b), matmul(b, a), -1)


def norm(a):
    return mp.sqrt(sum(abs(x) ** 2 for x in (flat(a) if isinstance(a[0], list) else a)))


def inverse(a):
    return (mp.matrix(a) ** -1).tolist()


def expm(a):
    """Matrix exponential: Taylor series, scaling and squaring with guard digits."""
    size = norm(a)
    halvings = max(0, int(mp.ceil(mp.log(size, 2))) + 8) if size else 0
    with mp.workdps(mp.dps + 10 + int(halvings * 0.7)):
        x = scaled(a, mp.ldexp(mpf(1), -halvings))
        total = power = eye(len(a))
        k = 0
        while k == 0 or norm(power) > mp.eps:
            k += 1
            power = scaled(matmul(power, x), mpf(1) / k)
            total = add(total, power)
        for _ in range(halvings):
            total = matmul(total, total)
        return total


# ---------------------------------------------------------------- so(3)

def hat(u):
    return [[mpf(0), -u[2], u[1]], [u[2], mpf(0), -u[0]], [-u[1], u[0], mpf(0)]]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def exp3(u):
    a = norm(u)
    if not a:
        return eye(3)
    h = hat(u)
    return add(add(eye(3), h, mp.sin(a) / a), matmul(h, h), 2 * mp.sin(a / 2) ** 2 / a ** 2)


def dexpinv3(u, v):
    a = norm(u)
    if not a:
        return list(v)
    with mp.workdps(mp.dps + max(0, int(-2 * mp.log10(a)) + 5)):
        c = (1 - a / 2 * mp.cot(a / 2)) / a ** 2
    uv = cross(u, v)
    return [x - y / 2 + c * z for x, y, z in zip(v, uv, cross(u, uv))]


def cay3(u):
    h, s = hat(u), 1 + sum(x * x for x in u) / 4
    return add(add(eye(3), h, 1 / s), matmul(h, h), 1 / (2 * s))


def dcayinv3(u, v):
    d = sum(x * y for x, y in zip(u, v)) / 4
    return [x - y / 2 + d * z for x, y, z in zip(v, cross(u, v), u)]


def axis_rotation(i, angle):
    c, s = mp.cos(angle), mp.sin(angle)
    j, k = (i + 1) % 3, (i + 2) % 3
    r = [[mpf(p == q) for q in range(3)] for p in range(3)]
    r[j][j], r[j][k], r[k][j], r[k][k] = c, -s, s, c
    return r


def ccsk(order):
    def value(u):
        r = eye(3)
        for i in order:
            r = matmul(r, axis_rotation(i, u[i]))
        return r
    return value


def dccskinv(order):
    def value(u, v):
        left, cols = eye(3), [None] * 3
        for i in order:
            cols[i] = [row[i] for row in left]
            left = matmul(left, axis_rotation(i, u[i]))
        det = sum(x * y for x, y in zip(cols[0], cross(cols[1], cols[2])))
        dual = [cross(cols[(i + 1) % 3], cols[(i + 2) % 3]) for i in range(3)]
        return [sum(x * y for x, y in zip(d, v)) / det for d in dual]
    return value


def by_expm(order=None):
    def value(u):
        if order is None:
            return expm(hat(u))
        r = eye(3)
        for i in order:
            r = matmul(r, expm(hat([x if j == i else mpf(0) for j, x in enumerate(u)])))
        return r
    return value


def by_solve(u):
    h = scaled(hat(u), mpf(1) / 2)
    return matmul(inverse(add(eye(3), h, -1)), add(eye(3), h))


FORWARD, BACKWARD = (0, 1, 2), (2, 1, 0)
SO3_MAPS = [("exp", exp3, by_expm(), "dexpinv", dexpinv3),
            ("cay", cay3, by_solve, "dcayinv", dcayinv3),
            ("ccsk123", ccsk(FORWARD), by_expm(FORWARD), "dccskinv123", dccskinv(FORWARD)),
            ("ccsk321", ccsk(BACKWARD), by_expm(BACKWARD), "dccskinv321", dccskinv(BACKWARD))]


def spectral3(columns):
    """2-norm of a 3x3 matrix given by columns."""
    size = norm(columns)
    if not size:
        return mpf(0)
    gram = [[sum(x * y for x, y in zip(p, q)) / size ** 2 for q in columns] for p in columns]
    return size * mp.sqrt(max(mp.eigsy(mp.matrix(gram), eigvals_only=True)))


def condition3(f, u, v):
    """Condition number with respect to (u, v), and to v alone."""
    size = norm(f(u, v))
    unit = [[mpf(i == j) for j in range(3)] for i in range(3)]
    h = mpf(10) ** -30 * min(norm(u) or 1, 1)
    du = []
    for e in unit:
        plus, minus = (f([x + s * h * y for x, y in zip(u, e)], v) for s in (1, -1))
        du.append([(x - y) / (2 * h) for x, y in zip(plus, minus)])
    dv = [f(u, e) for e in unit]
    by_u, by_v = spectral3(du) * norm(u) / size, spectral3(dv) * norm(v) / size
    return by_u + by_v, by_v


def so3_points():
    """Vectors u as tuples of doubles."""
    pi = math.pi
    generic = [(0.48, -0.6, 0.64), (-0.36, 0.48, 0.8), (2 / 3, 2 / 3, -1 / 3), (-0.2, -0.4, -0.9)]
    axes = [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)]
    nearly = [(1.0, 1e-9, -1e-12), (1e-8, -1.0, 1e-10), (-1e-13, 1e-7, 1.0)]
    norms = [0.0, 1e-320, 1e-160, 1e-16, 1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 3.0,
             pi - 1e-3, pi - 1e-6, pi - 1e-10, pi, 3.2, 5.0, 6.0, 2 * pi - 1e-2, 2 * pi - 1e-6,
             2 * pi - 1e-10, 7.0, 10.0, 100.0, 1e4, 1e8, 1e15, 1e160]

    def point(size, d):
        length = math.sqrt(sum(x * x for x in d))
        return tuple(size * (x / length) if x else 0.0 for x in d)

    for i, size in enumerate(norms):
        yield point(size, generic[i % 4])
    for i, size in enumerate((1e-320, 1e-8, 1e-3, 0.5, 1.0, 2.0, pi, 3.2, 2 * pi - 1e-2, 2 * pi - 1e-6,
                              2 * pi - 1e-10, 10.0, 1e8)):
        yield point(size, axes[i % 3])
    for i, size in enumerate((1e-160, 1e-4, 0.1, 1.0, 3.0, pi - 1e-6, pi - 1e-10, 5.0, 2 * pi - 1e-6, 7.0, 1e4)):
        yield point(size, nearly[i % 3])
    yield point(pi / 2, axes[1])            # nearest double to the gimbal position
    yield (0.3, 3 * pi / 2, -0.7)
    for k in (4, 8, 12):
        yield (0.3, pi / 2 - 10.0 ** -k, -0.7)
        yield (-2.1, -pi / 2 + 10.0 ** -k, 0.0)


def digits(x, count=DIGITS3):
    """Decimal string, or None outside the range of doubles."""
    return None if abs(x) > mpf(2) ** 1024 - mpf(2) ** 970 else mp.nstr(mpf(x), count)


def group(values, count=DIGITS3):
    out = [digits(x, count) for x in values]
    return None if None in out else out


def make_so3():
    rng = random.Random(3)
    out = []
    for uf in so3_points():
        vf = tuple(round(rng.gauss(0, 1), 6) for _ in range(3))
        ident = str(uf)
        size = max(map(abs, uf))
        outputs = {}
        with mp.workdps(260 + (4 * int(math.log10(size)) if size > 1 else 0)):
            u, v = [mpf(x) for x in uf], [mpf(x) for x in vf]
            for name, psi, other, dname, dinv in SO3_MAPS:
                g, w = psi(u), dinv(u, v)
                with mp.workdps(80 if size < 1e8 else mp.dps):
                    g2 = other(u)
                check(name, ident, norm(add(g, g2, -1)))
                check(name + " orthogonal", ident, norm(add(matmul(g, transpose(g)), eye(3), -1)))
                h = mpf(10) ** -60 / max(1, norm(w))
                gp, gm = (psi([x + s * h * y for x, y in zip(u, w)]) for s in (1, -1))
                slope = scaled(matmul(add(gp, gm, -1), transpose(g)), 1 / (2 * h))
                cond, cond_v = condition3(dinv, u, v)
                check(dname, ident, norm(add(slope, hat(v), -1)) / norm(v) * cond_v)
                outputs[name] = value(group(flat(g)))
                outputs[dname] = value(group(w), cond=digits(cond, 3))
        out.append(case(f"vector_{len(out)}", "so", 3, {"u": exact(uf), "v": exact(vf)}, outputs))
    return out


# ---------------------------------------------------------------- general matrices

def so_element(rng, n):
    a = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i):
            a[i][j] = rng.gauss(0, 1)
            a[j][i] = -a[i][j]
    return a


def sp_element(rng, n):
    m = n // 2
    a = [[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)]
    for i in range(m):
        for j in range(m):
            a[m + j][m + i] = -a[i][j]
            if j < i:
                a[i][m + j], a[m + i][j] = a[j][m + i], a[m + j][i]
    return a


def gl_element(rng, n):
    return [[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)]


def lorentz_element(rng, n):
    a = so_element(rng, n)
    for i in range(n - 1):
        a[i][n - 1] = a[n - 1][i]
    return a


def spectral(a):
    """2-norm of a float matrix (power iteration)."""
    x = [1.0 + 0.1 * i for i in range(len(a))]
    for _ in range(300):
        y = [sum(p * q for p, q in zip(r, x)) for r in a]
        x = [sum(p * q for p, q in zip(c, y)) for c in zip(*a)]
        s = math.sqrt(sum(t * t for t in x))
        x = [t / s for t in x]
    return math.sqrt(s)


def operator_norm(apply, adjoint, n):
    """Frobenius operator norm of a linear map of n x n float matrices (power iteration)."""
    rng = random.Random(n)
    x = [[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)]
    old = value = 0.0
    for _ in range(400):
        size = math.sqrt(sum(abs(t) ** 2 for t in flat(x)))
        x = scaled(x, 1 / size)
        y = apply(x)
        value = math.sqrt(sum(abs(t) ** 2 for t in flat(y)))
        if value == 0 or abs(value - old) < 1e-6 * value:
            break
        old, x = value, adjoint(y)
    return value


def star(a):
    return [[complex(x).conjugate() for x in r] for r in zip(*a)]


def phi(z):
    """z/(e^z - 1) for complex floats."""
    if abs(z) < 0.1:
        return 1 - z / 2 + z**2 / 12 - z**4 / 720 + z**6 / 30240 - z**8 / 1209600
    return z / (cmath.exp(z) - 1)


def divided(f, z, w):
    """Divided difference f[z, w] for complex floats."""
    if abs(z - w) > 1e-5:
        return (f(z) - f(w)) / (z - w)
    mid, h = (z + w) / 2, 1e-5      # symmetric difference, error O(h^2)
    return (f(mid + h) - f(mid - h)) / (2 * h)


def condition_general(lam, V, Vi, u, v, w):
    """cond_exp and cond_dexpinv from an eigendecomposition (floats); w = None: no dexpinv."""
    n = len(lam)
    lam = [complex(x) for x in lam]
    V, Vi = ([[complex(x) for x in r] for r in a] for a in (V, Vi))
    Vs, Vis = star(V), star(Vi)
    idx = range(n)

    def conjugated(inner):
        return lambda x: matmul(matmul(V, inner(matmul(matmul(Vi, x), V))), Vi)

    def adjoint_of(inner):
        return lambda y: matmul(matmul(Vis, inner(matmul(matmul(Vs, y), Vis))), Vs)

    def hadamard(coef):
        inner = lambda x: [[c * t for c, t in zip(p, q)] for p, q in zip(coef, x)]
        conj = [[c.conjugate() for c in r] for r in coef]
        inner_adjoint = lambda x: [[c * t for c, t in zip(p, q)] for p, q in zip(conj, x)]
        return operator_norm(conjugated(inner), adjoint_of(inner_adjoint), n)

    L = hadamard([[divided(cmath.exp, lam[j], lam[k]) for k in idx] for j in idx])
    nu, ne = float(norm(u)), math.sqrt(sum(abs(t) ** 2 for t in flat(matmul(matmul(
        V, [[cmath.exp(lam[i]) if i == j else 0 for j in idx] for i in idx]), Vi))))
    cond_exp = L * nu / ne
    if w is None:
        return cond_exp, None
    z = [[lam[j] - lam[k] for k in idx] for j in idx]
    dv = hadamard([[phi(z[j][k]) for k in idx] for j in idx])
    X = matmul(matmul(Vi, [[complex(t) for t in r] for r in v]), V)
    # derivative of phi(ad_u) v in direction W, in the eigenbasis
    P = [[[divided(phi, z[j][k], z[a][k]) * X[a][k] for a in idx] for k in idx] for j in idx]
    Q = [[[divided(phi, z[j][k], z[j][b]) * X[j][b] for b in idx] for k in idx] for j in idx]

    def inner(W):
        return [[sum(P[j][k][a] * W[j][a] - Q[j][k][a] * W[a][k] for a in idx) for k in idx] for j in idx]

    def inner_adjoint(Y):
        return [[sum(P[j][k][a].conjugate() * Y[j][k] - Q[k][a][j].conjugate() * Y[k][a] for k in idx)
                 for a in idx] for j in idx]

    du = operator_norm(conjugated(inner), adjoint_of(inner_adjoint), n)
    return cond_exp, (du * nu + dv * float(norm(v))) / float(norm(w))


def special_cases():
    """(id, group, u): rotations in two planes near the singular set, repeated eigenvalues, no cay."""
    def planes(a, b):
        return [[0.0, -a, 0.0, 0.0], [a, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, -b], [0.0, 0.0, b, 0.0]]

    yield "so4_sum_near_2pi_2e-3", "so", planes(3.0, 2 * math.pi - 3.0 - 2e-3)
    yield "so4_sum_near_2pi_1e-6", "so", planes(3.0, 2 * math.pi - 3.0 - 1e-6)
    yield "so4_near_isoclinic", "so", planes(2.0, 2.0 + 1e-9)
    yield "so4_isoclinic", "so", planes(2.0, 2.0)
    yield "so4_one_plane", "so", planes(2.5, 0.0)
    yield "sp2_cay_singular", "sp", [[2.0, 0.0], [0.0, -2.0]]
    yield "sp2_hyperbolic_30", "sp", [[18.0, 24.0], [24.0, -18.0]]
    yield "lorentz4_boost_8", "lorentz", [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 8.0],
                                          [0.0, 0.0, 0.0, 0.0], [0.0, 8.0, 0.0, 0.0]]


def make_general():
    kinds = [("so", 4, so_element), ("so", 5, so_element), ("so", 8, so_element),
             ("sp", 2, sp_element), ("sp", 4, sp_element), ("sp", 6, sp_element),
             ("gl", 2, gl_element), ("gl", 3, gl_element), ("gl", 5, gl_element),
             ("lorentz", 4, lorentz_element)]
    rng = random.Random(5)
    out = []
    for name, n, element in kinds:
        for size in (0.01, 0.3, 1.0, 3.0, 8.0):
            ident = f"{name}{n}_{size:g}"
            uf, vf = element(rng, n), element(rng, n)
            uf = scaled(uf, size / spectral(uf))
            vf = scaled(vf, 1 / spectral(vf))
            out.append(general_case(ident, name, n, uf, vf))
    elements = {"so": so_element, "sp": sp_element, "lorentz": lorentz_element}
    for ident, name, uf in special_cases():
        n = len(uf)
        vf = elements[name](rng, n)
        vf = scaled(vf, 1 / spectral(vf))
        out.append(general_case(ident, name, n, uf, vf))
    return out


def general_case(ident, kind, n, uf, vf):
    mp.dps = 80
    u = [[mpf(x) for x in r] for r in uf]
    v = [[mpf(x) for x in r] for r in vf]
    one = eye(n)
    relative = lambda a, b: norm(add(a, b, -1)) / norm(b)

    def slope(f, g, w):
        """Central difference of f at u along w, times g^-1."""
        with mp.workdps(150):
            h = mpf(10) ** -40 / max(1, norm(w))
            diff = add(f(add(u, w, h)), f(add(u, w, -h)), -1)
            return scaled(matmul(diff, inverse(g)), 1 / (2 * h))

    g = expm(u)
    with mp.workdps(100):
        check("general exp", ident, relative(g, mp.expm(mp.matrix(u), method="pade").tolist()))
    lam, V = mp.eig(mp.matrix(u))
    lam, V = list(lam), V.tolist()
    Vi = inverse(V)
    X = matmul(matmul(Vi, v), V)
    singular, w = mp.inf, None
    for j in range(n):
        for k in range(n):
            z = lam[j] - lam[k]
            turn = mp.nint(z.imag / (2 * mp.pi))
            if turn:
                singular = min(singular, abs(z - 2j * mp.pi * turn))
            if j != k:
                X[j][k] *= z / mp.expm1(z) if z else 1
    if singular > 1e-3:
        w = matmul(matmul(V, X), Vi)
        check("general dexpinv real", ident, max(abs(mp.im(x)) for x in flat(w)) / norm(w))
        w = [[mp.re(x) for x in r] for r in w]
    cond_exp, cond_dexpinv = condition_general(lam, V, Vi, u, v, w)
    if w is not None:
        total, term, k = w, w, 1
        while norm(term) > mp.eps * norm(w):
            k += 1
            term = scaled(commutator(u, term), mpf(1) / k)
            total = add(total, term)
        check("general dexp(dexpinv)", ident, relative(total, v) * max(1, cond_dexpinv))
        check("general dexpinv differences", ident, relative(slope(expm, g, w), v) * max(1, cond_dexpinv))

    def cayley(a):
        return matmul(inverse(add(one, a, mpf(-1) / 2)), add(one, a, mpf(1) / 2))

    c = dc = None
    if min(abs(x - 2) for x in lam) > 1e-3:
        c = cayley(u)
        with mp.workdps(100):
            c2 = add(scaled(inverse(add(one, u, mpf(-1) / 2)), 2), one, -1)
        check("general cay", ident, relative(c, c2))
        dc = add(add(v, commutator(u, v), mpf(-1) / 2), matmul(matmul(u, v), u), mpf(-1) / 4)
        if min(abs(x + 2) for x in lam) > 1e-3:
            check("general dcayinv differences", ident, relative(slope(cayley, c, dc), v))
    text = lambda a: None if a is None else group(flat(a), DIGITS)
    short = lambda x: None if x is None else f"{x:.3g}"
    return case(ident, kind, n, {"u": exact(flat(uf)), "v": exact(flat(vf))}, {
        "exp": value(text(g), cond=short(cond_exp)), "dexpinv": value(text(w), cond=short(cond_dexpinv)),
        "cay": value(text(c)), "dcayinv": value(text(dc))})


def main():
    write("maps", "Coordinate maps and their inverse differentials, on so(3) and on matrix algebras.",
          make_so3() + make_general())
