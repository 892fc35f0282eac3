"""200 blocks under 40 ground motions: overturning frequencies, and the intensity measure that predicts them best.

python examples/python/ensemble.py
"""

from pathlib import Path

import numpy as np

import rocking_block as rb

ROOT = Path(__file__).resolve().parents[2]


def motions() -> list[rb.Record]:
    """Returns 40 motions made from two recorded ones, scaled to 4 m/s² and played at twenty speeds.

    They demonstrate the method, but are not 40 earthquakes.
    """
    recorded = [rb.read_record(ROOT / "examples/records" / name) for name in ("np01002p_4225a_a.smc", "0111a.smc")]
    return [
        rb.Record(record.acceleration / record.pga * 4.0, record.dt * stretch, f"{i}, time × {stretch:.2f}")
        for i, record in enumerate(recorded)
        for stretch in np.linspace(0.5, 1.45, 20)
    ]


if __name__ == "__main__":
    random = np.random.default_rng(1)
    blocks = rb.blocks(alpha=random.uniform(0.1, 0.25, 200), p=random.uniform(1.2, 3.5, 200), eta=60, epsilon=0.1)
    table = rb.outcomes(blocks, motions())
    overturned = (table["outcome"] == "overturned").reshape(table.shape)
    print(f"{overturned.mean():.1%} of {overturned.size} runs overturn")
    print("block that overturns most often:", blocks[overturned.mean(axis=0).argmax()])
    for im in ("PGA/(g tan alpha)", "p PGV/(g tan alpha)", "p T_m"):
        print(f"{im}: area under the receiver operating characteristic {rb.fragility(table, im).auc:.3f}")
    print(table.to_frame().groupby("record")["peak.theta/alpha"].median().sort_values().tail(3))
