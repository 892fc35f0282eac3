"""Typical uses of the package, for type checkers."""

import numpy as np
import numpy.typing as npt

import rocking_block as rb

record: rb.Record = rb.read_record("RSN1063.AT2", unit="g")
synthetic = rb.Record([0.0, 1.0], 0.01, name="made up")
block = rb.Block(alpha=0.2, p=1.5, eta=60, xi_v=0.1)
rigid: rb.Block = block.replace(foundation="rigid")
run: rb.Run = block.run(record, vertical=synthetic, scale=2, on_separation="hold", pulse=rb.Pulse("c1", 1.0, 2.0))
rotation: npt.NDArray[np.float64] = run.theta
energy: float = float(run.energy.total[-1])
times: list[float] = [event.t for event in run.events if event.corner == "L"]
table: rb.Table = rb.spectrum(alpha=0.2, p=np.geomspace(0.5, 5, 400), eta=[40, 80], xi_v=0.1, records=[record, "b.smc"])
overturned = (table["outcome"] == "overturned").reshape(table.shape).mean(axis=0)
table = rb.sweep({"study": {"design": "grid"}, "parameters": {"pulse.amplitude": [1.0, 2.0]}})
table = rb.outcomes([block, rigid], record, scale=np.linspace(1, 2, 5))
least: float | None = rb.search_overturning(block, pulse=rb.Pulse("one-sine", period=1.0)).least
hazard: rb.Hazard = rb.Hazard([0.1, 1.0], [1e-2, 1e-4], im="PGV", unit="m/s")
once_in: float = rb.annual_rate(hazard, (0.5, 0.4), "PGV [m/s]").return_period
axes = block.plot()
support: rb.foundations.Support = rb.foundations.pad(diameter=0.5, shape_factor=12, shear_modulus=0.9e6)
frictions: list[float] = [pair.low for pair in rb.foundations.pairs("friction")]
