"""A fragility curve of statues: 24 of uncertain size under 40 ground motions at 5 strengths.

python examples/python/fragility.py
"""

import matplotlib.pyplot as plt
import numpy as np
from ensemble import motions

import rocking_block as rb

random = np.random.default_rng(2)
statues = rb.blocks(alpha=random.normal(0.16, 0.01, 24), p=random.uniform(1.8, 2.4, 24), eta=50, xi_v=0.2)
table = rb.outcomes(statues, motions(), scale=np.geomspace(0.5, 2.0, 5))

# Runs of the same motion are not independent of each other: whole records are resampled.
fit = rb.fragility(table, im="PGV", limit="overturned", intervals="bootstrap")
print(fit)
print("probability at 0.5 m/s:", fit.curve(0.5), "between", *fit.band(0.5))
fit.plot()
plt.savefig("fragility.png", dpi=110)
