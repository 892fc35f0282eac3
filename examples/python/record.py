# %% [markdown]
# # A block in an earthquake
#
# Cells for Jupyter (with jupytext) or an editor that supports `# %%`; also a plain script, after `cargo build --release` and
# `pip install -r tests/python/requirements.txt -r examples/python/requirements.txt`.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy import simulate_fmu

# A notebook has no `__file__`; it starts somewhere in the project.
here = Path(__file__).resolve() if "__file__" in globals() else Path.cwd()
sys.path.insert(0, str(next(p / "examples" for p in [here, *here.parents] if (p / "examples/common.py").exists())))
from common import BLOCK, RECORD, read_record

# %% [markdown]
# ## The record
# APEEL Array #2, Redwood City, in the Loma Prieta earthquake of 1989; U.S. Geological Survey, public domain. Doubled, so that
# the block rocks. `read_record` accepts every format that `rocking` reads.

# %%
time, a_gx = read_record(RECORD)
a_gx = 2 * a_gx
dt = time[1] - time[0]
print(f"{len(a_gx)} samples every {dt:g} s, greatest acceleration {np.abs(a_gx).max():.2f} m/s²")

# %% [markdown]
# ## The block
# 3.2 m high and 0.8 m wide, on stiff supports. fmpy's `simulate_fmu` holds the record over each communication step, which is
# `output_interval`, so that is a fifth of the record's interval.

# %%
block = {
    "parameterization": 2,  # Physical
    "physical.width": 0.8,
    "physical.height": 3.2,
    "physical.K": 1.0e7,
    "physical.C": 4.0e4,
    "mass": 4000.0,
    "on_separation": 3,  # Fly
    "on_overturning": 2,  # Hold
}
result = simulate_fmu(
    BLOCK,
    start_values=block,
    input=np.array(list(zip(time, a_gx)), dtype=[("time", float), ("a_gx", float)]),
    stop_time=time[-1],
    output_interval=dt / 5,
    output=["theta", "N_L", "N_R", "regime", "overturned", "energy.residual", "energy.total"],
)
print(f"greatest rotation {np.abs(result['theta']).max():.4f} rad of {np.arctan2(0.8, 3.2):.4f} rad,",
      "overturned" if result["overturned"][-1] else "still standing")

# %%
figure, axes = plt.subplots(3, 1, figsize=(10, 8), sharex=True, layout="constrained")
axes[0].plot(time, a_gx, lw=0.7, color="0.4")
axes[0].set(ylabel="m/s²", title="Ground acceleration")
axes[1].plot(result["time"], result["theta"])
axes[1].set(ylabel="rad", title="Rotation")
axes[2].plot(result["time"], result["N_L"] / 1e3, lw=0.7, label="left")
axes[2].plot(result["time"], result["N_R"] / 1e3, lw=0.7, label="right")
axes[2].set(xlabel="time [s]", ylabel="kN", title="Reactions of the corners")
axes[2].legend()
plt.show()
