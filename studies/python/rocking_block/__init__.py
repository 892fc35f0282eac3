"""Rigid blocks that rock on viscoelastic supports, or on a rigid base, under earthquakes and pulses.

The model is that of A. Palmeri and N. Makris, Response analysis of rigid structures rocking on viscoelastic foundation,
Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800; equation numbers are the
paper's. SI units, angles in radians; rotation, horizontal motion and forces are positive to the right, vertical ones
up.

    record = rb.read_record("RSN1063.AT2")
    block = rb.Block(alpha=0.2, p=1.5, eta=60, xi_v=0.1)
    run = block.run(record)
    table = rb.spectrum(alpha=0.2, p=np.geomspace(0.5, 5, 400), eta=[40, 80], xi_v=0.1, records=[record])
"""

from rocking_block import foundations
from rocking_block._assess import Assessment, Portfolio, assess, portfolio
from rocking_block._block import Block
from rocking_block._building import Building, FloorMotions, floor_motions
from rocking_block._cloud import Cloud, Share, Stripes, Sufficiency, cloud, stripes
from rocking_block._engine import __version__
from rocking_block._fit import Combination, Estimate, Fit, Test, TestFit, fit
from rocking_block._fmu import fmu_path
from rocking_block._fragility import Fragility, export_fragility, fragility, intensity
from rocking_block._frame import Frame, FrameRun, frame
from rocking_block._ida import Ida, IdaCurve, ida
from rocking_block._in_space import BlockInSpace, CountsInSpace, EventInSpace, PeakInSpace, RunInSpace
from rocking_block._pulse import Pulse, PulseFit, fit_pulse
from rocking_block._pushover import Cycle, Landmark, Pushover
from rocking_block._rate import AnnualRate, Hazard, annual_rate, read_hazard
from rocking_block._record import Record, read_record, records_from
from rocking_block._run import Counts, Energy, Event, Gradient, Grazing, Peak, Run
from rocking_block._search import Search, search_damping, search_overturning
from rocking_block._studies import blocks, outcomes, spectrum, sweep
from rocking_block._surface import Surface
from rocking_block._table import Table, read_table
from rocking_block._tie import Damper, Tie

__all__ = [
    "AnnualRate",
    "Assessment",
    "Block",
    "BlockInSpace",
    "Building",
    "Cloud",
    "Combination",
    "Counts",
    "CountsInSpace",
    "Cycle",
    "Damper",
    "Energy",
    "Estimate",
    "Event",
    "EventInSpace",
    "Fit",
    "FloorMotions",
    "Fragility",
    "Frame",
    "FrameRun",
    "Gradient",
    "Grazing",
    "Hazard",
    "Ida",
    "IdaCurve",
    "Landmark",
    "Peak",
    "PeakInSpace",
    "Portfolio",
    "Pulse",
    "PulseFit",
    "Pushover",
    "Record",
    "Run",
    "RunInSpace",
    "Search",
    "Share",
    "Stripes",
    "Sufficiency",
    "Surface",
    "Table",
    "Test",
    "TestFit",
    "Tie",
    "annual_rate",
    "assess",
    "blocks",
    "cloud",
    "export_fragility",
    "fit",
    "fit_pulse",
    "floor_motions",
    "fmu_path",
    "foundations",
    "fragility",
    "frame",
    "ida",
    "intensity",
    "outcomes",
    "portfolio",
    "read_hazard",
    "read_record",
    "read_table",
    "records_from",
    "search_damping",
    "search_overturning",
    "spectrum",
    "stripes",
    "sweep",
]
