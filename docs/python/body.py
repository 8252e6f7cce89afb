import matplotlib.pyplot as plt, numpy as np, lieflow as lf
body = lf.RigidBody(inertia=[0.0026, 0.0103, 0.0108], omega_body=[0.01, 1.0, 0.0])
r = lf.solve_ivp(body, (0, 100), t_eval=np.linspace(0, 100, 1001), quantities="omega_body", events="w2")
plt.figure(figsize=(7, 2.4)); plt.plot(r.t, r.omega_body, label=["ω₁", "ω₂", "ω₃"])
plt.plot(r.t_events[0], 0 * r.t_events[0], "k."); plt.legend(loc="right"); plt.xlabel("t / s"); plt.ylabel("ω / (rad/s)")
plt.savefig("body.svg", bbox_inches="tight", metadata={"Date": None})
