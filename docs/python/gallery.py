"""Draws the pictures of docs/python.md: `python docs/python/gallery.py`. Needs matplotlib."""

import pathlib

import matplotlib.pyplot as plt
import numpy as np

import lieflow as lf

plt.rcParams["svg.hashsalt"] = "lieflow"  # the same file each time
HERE = pathlib.Path(__file__).parent


def save(figure, name):
    figure.savefig(HERE / f"{name}.svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def axes(count=1, height=2.6, **more):
    return plt.subplots(1, count, figsize=(7, height), layout="constrained", **more)


def body():
    """The first picture: its six lines are those of the README."""
    exec((HERE / "body.py").read_text().replace('"body.svg"', repr(str(HERE / "body.svg"))), {})
    plt.close("all")


def sphere():
    """The momentum of a free body on its sphere: the lines of equal energy."""
    figure, axis = plt.subplots(figsize=(4, 4), subplot_kw={"projection": "3d"}, layout="constrained")
    for angle in np.linspace(0.05, 1.52, 12):
        for sign in (-1, 1):
            for start in ([np.sin(angle), 0, sign * np.cos(angle)], [sign * np.cos(angle), 0, np.sin(angle)]):
                free = lf.RigidBody(inertia=[1.0, 2.0, 3.0], momentum_body=start)
                m = lf.solve_ivp(free, (0, 40), t_eval=np.linspace(0, 40, 400), quantities="momentum_body").momentum_body
                axis.plot(*m.T, color="tab:blue", linewidth=0.6)
    axis.set(xlabel="m₁", ylabel="m₂", zlabel="m₃", box_aspect=(1, 1, 1))
    save(figure, "sphere")


def landau_zener():
    """A level is swept through another one; the line is the probability of Landau and Zener."""
    figure, axis = axes()
    for gap in (0.4, 0.8, 1.6):
        def field(t, gap=gap):
            return -1j * np.array([[-t / 2, gap / 2], [gap / 2, t / 2]])

        t = np.linspace(-30, 60, 1500)
        r = lf.solve_ivp(field, (-30, 60), [1, 0], group="U(2)", action="linear", linear=True, method="magnus6",
                         steps=9000, t_eval=t)
        (line,) = axis.plot(t, np.abs(r.y[:, 0]) ** 2, label=f"gap {gap}", linewidth=0.8)
        axis.axhline(np.exp(-np.pi * gap**2 / 2), color=line.get_color(), linestyle=":")
    axis.set(xlabel="t", ylabel="probability to stay", ylim=(0, 1.02))
    axis.legend(loc="lower left")
    save(figure, "landau-zener")


def two_codes():
    """How far SciPy's rotation matrix leaves the rotations, and lieflow's."""
    from scipy.integrate import solve_ivp

    inertia, m = np.array([1.0, 4.0, 18.0]), np.array([0.0, 2.75, 2.75])
    t = np.linspace(0, 400, 400)
    entries = lambda t, y: (y.reshape(3, 3) @ lf.so3.hat((m @ y.reshape(3, 3)) / inertia)).ravel()  # noqa: E731
    left = solve_ivp(entries, (0, 400), np.eye(3).ravel(), method="DOP853", rtol=1e-6, atol=1e-6, t_eval=t)
    kept = lf.solve_ivp(lambda t, R: (m @ R) / inertia, (0, 400), np.eye(3), group="SO(3)", frame="body", rtol=1e-6,
                        atol=1e-6, t_eval=t)
    figure, axis = axes()
    for name, R in (("SciPy DOP853", left.y.T.reshape(-1, 3, 3)), ("lieflow", kept.y)):
        off = np.linalg.norm(np.swapaxes(R, 1, 2) @ R - np.eye(3), axis=(1, 2))
        axis.semilogy(t, np.maximum(off, 1e-17), label=name)
    axis.set(xlabel="t", ylabel="‖RᵀR − 1‖")
    axis.legend()
    save(figure, "two-codes")


def spin_wave():
    """A spin wave in a chain: one component of each spin, as a map of site and time."""
    scene = lf.load("spin-wave")
    t = np.linspace(*scene.t_span, 300)
    spins = lf.solve_ivp(scene.problem, scene.t_span, t_eval=t, quantities="spins").spins.reshape(300, -1, 3)
    figure, axis = axes()
    picture = axis.imshow(spins[..., 0].T, cmap="RdBu", aspect="auto", origin="lower", extent=(t[0], t[-1], 0.5, spins.shape[1] + 0.5))
    axis.set(xlabel="t", ylabel="site")
    figure.colorbar(picture, label="s₁")
    save(figure, "spin-wave")


if __name__ == "__main__":
    for draw in (body, sphere, landau_zener, two_codes, spin_wave):
        draw()
