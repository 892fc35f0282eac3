"""A block under an earthquake: the record, the run, a data frame and a picture.

python examples/python/one_record.py [RECORD]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import rocking_block as rb

ROOT = Path(__file__).resolve().parents[2]

# Any format: PEER AT2, USGS SMC, COSMOS, CSMIP, ESM, CSV. This one is of Loma Prieta, 1989.
record = rb.read_record(sys.argv[1] if len(sys.argv) > 1 else ROOT / "examples/records/np01002p_4225a_a.smc")
block = rb.Block(width=0.8, height=3.2, K=1e7, C=4e4, mass=4000)
print(record, block, sep="\n")

run = block.run(record, scale=2)
print(run)
print(run.to_frame()[["theta", "N_L", "N_R", "H"]].describe())
print("first impact:", next(event for event in run.events if event.event == "landing"))
run.plot()
plt.savefig("one_record.png", dpi=110)
