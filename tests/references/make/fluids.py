"""Reference values of Zeitlin's fluids: writes fluids.json.

Everything comes from definitions by matrices in 60 digits and nothing from closed forms of a
Laplacian: on the sphere Laplacian(P) = -sum_a [J_a, [J_a, P]] as an N^2 x N^2 system with the spin
matrices, on the torus by the coefficients of the clock-and-shift basis. `p` is the inverse Laplacian
of the vorticity w (of its traceless part), `dw` = [P, W]/hbar, `isospectral` and `energy` one step of the two midpoint rules
from w with the step h. `diagonals` are the quantised harmonics on the m-th diagonal above the main
one, from J_+^l by commutators with J_- (no eigenvectors), of square sum N, those nearest to the
north pole positive.

w has doubles as entries (repr), references belong to their exact values; 34 digits are written.
Two ways agree: the residual of every step's equation in its other form, and -l(l+1) on every
harmonic, to 1e-45.
"""
import random

from mpmath import mp, mpc, mpf

from .schema import case, value, write

mp.dps = 60


def zeros(n):
    return mp.matrix(n, n)


def dagger(a):
    return a.transpose_conj()


def comm(a, b):
    return a * b - b * a


def size(a):
    return mp.sqrt(sum(abs(x) ** 2 for x in a))


def spins(n):
    """J_1, J_2, J_3 in the order of falling eigenvalues of J_3."""
    up = zeros(n)
    for i in range(1, n):
        up[i - 1, i] = mp.sqrt(mpf(i * (n - i)))
    down = up.T
    third = mp.diag([mpf(n - 1) / 2 - i for i in range(n)])
    return (up + down) / 2, (up - down) / mpc(0, 2), third


def random_vorticity(n, rng):
    """Skew-Hermitian and exactly of trace 0."""
    w = zeros(n)
    for i in range(n):
        for j in range(i):
            re, im = rng.uniform(-1, 1), rng.uniform(-1, 1)
            w[i, j], w[j, i] = mpc(re, im), mpc(-re, im)
    last = mpf(0)
    for i in range(n - 1):
        x = mpf(round(rng.uniform(-1, 1) * 1024)) / 1024
        w[i, i], last = mpc(0, x), last - x
    w[n - 1, n - 1] = mpc(0, last)
    return w


def sphere_solver(n):
    js = spins(n)

    def laplacian(p):
        total = zeros(n)
        for j in js:
            total -= comm(j, comm(j, p))
        return total

    # The matrix of the Laplacian, and the row of the trace in place of a dependent one.
    big = mp.matrix(n * n, n * n)
    for k in range(n * n):
        unit = zeros(n)
        unit[k // n, k % n] = 1
        image = laplacian(unit)
        for i in range(n * n):
            big[i, k] = image[i // n, i % n]
    for k in range(n * n):
        big[n * n - 1, k] = 1 if k // n == k % n else 0
    inverse = big ** -1

    def solve(w):
        w = w - sum(w[i, i] for i in range(n)) / n * mp.eye(n)
        b = mp.matrix([w[k // n, k % n] for k in range(n * n)])
        b[n * n - 1] = 0
        x = inverse * b
        p = zeros(n)
        for k in range(n * n):
            p[k // n, k % n] = x[k]
        assert size(laplacian(p) - w) < mpf(10) ** -45
        return p

    return laplacian, solve, mp.sqrt(mpf(n * n - 1)) / 2


def torus_solver(n):
    k = (n - 1) // 2
    zeta = mp.expjpi(mpf(2) / n)
    clock = mp.diag([zeta ** r for r in range(n)])
    shift = zeros(n)
    for r in range(n):
        shift[r, (r + 1) % n] = 1

    def basis(a, b):
        power = shift ** (b % n)
        return mp.expjpi(mpf(a * b) / n) * (clock ** (a % n)) * power

    modes = [(a, b, basis(a, b)) for a in range(-k, k + 1) for b in range(-k, k + 1)]
    for (a, b, s) in modes[::3]:
        for (c, d, t) in modes[::5]:
            # [T_m, T_n] = -2i sin(pi (m x n)/N) T_{m+n}, with T of any integers.
            right = mpc(0, -2) * mp.sinpi(mpf(a * d - b * c) / n) * basis(a + c, b + d)
            assert size(comm(s, t) - right) < mpf(10) ** -45

    def scaled(w, f):
        total = zeros(n)
        for (a, b, t) in modes:
            if (a, b) != (0, 0):
                inner = sum(x.conjugate() * y for x, y in zip(t, w)) / n
                total += f(mpf(a * a + b * b)) * inner * t
        return total

    return lambda p: scaled(p, lambda s: -s), lambda w: scaled(w, lambda s: -1 / s), mpf(n) / (2 * mp.pi)


def fixed_point(f, x):
    for _ in range(400):
        y = f(x)
        done = size(y - x) < mpf(10) ** -55
        x = y
        if done:
            return x
    raise AssertionError("no convergence")


def steps(w, solve, rate, h):
    n, one, e = w.rows, mp.eye(w.rows), h * rate / 2
    m = fixed_point(lambda m: w + comm(e * solve(m), m) + e * solve(m) * m * e * solve(m), w)
    p = e * solve(m)
    assert size((one - p) * m * (one + p) - w) < mpf(10) ** -45
    isospectral = (one + p) * m * (one - p)

    def next_energy(x):
        p = e * solve((w + x) / 2)
        cay = (one - p) ** -1 * (one + p)
        return cay * w * dagger(cay)

    energy = fixed_point(next_energy, w)
    p = e * solve((w + energy) / 2)
    assert size((one - p) * energy * (one + p) - (one + p) * w * (one - p)) < mpf(10) ** -45
    return isospectral, energy


def text(x):
    return mp.nstr(mpf(x), 34, strip_zeros=False)


def entries(a):
    return [[text(mp.re(x)), text(mp.im(x))] for x in a]


def system(name, n, solver, seed, h):
    rng = random.Random(seed)
    laplacian, solve, rate = solver(n)
    w = random_vorticity(n, rng)
    p = solve(w)
    assert size(laplacian(p) - w) < mpf(10) ** -45
    isospectral, energy = steps(w, solve, rate, mpf(h))
    exact = [[repr(float(mp.re(x))), repr(float(mp.im(x)))] for x in w]
    return case(name, "u", n, {"h": [repr(h)], "w": exact}, {
        "p": value(entries(p)), "dw": value(entries(rate * comm(p, w))),
        "isospectral": value(entries(isospectral)), "energy": value(entries(energy))})


def harmonics(n):
    laplacian, _, _ = sphere_solver(n)
    j1, j2, _ = spins(n)
    up, down = j1 + mpc(0, 1) * j2, j1 - mpc(0, 1) * j2
    found = []
    for l in range(n):
        t = up ** l if l else mp.eye(n)
        for m in range(l, -1, -1):
            assert size(laplacian(t) + l * (l + 1) * t) < mpf(10) ** -40 * size(t)
            v = [mp.re(t[i, i + m]) for i in range(n - m)]
            scale = mp.sqrt(n / sum(x * x for x in v)) * mp.sign(v[0])
            diagonal = value([text(scale * x) for x in v])
            found.append(case(f"harmonic_{l}_{m}", "u", n, {"l": [str(l)], "m": [str(m)]}, {"diagonal": diagonal}))
            t = comm(down, t)
    return found


def main():
    write("fluids", "Zeitlin's fluids on the sphere and the torus, from definitions by matrices.", [
        system("sphere", 5, sphere_solver, 1, 0.125),
        system("sphere", 6, sphere_solver, 2, 0.0625),
        system("torus", 5, torus_solver, 3, 0.125),
    ] + harmonics(9))
