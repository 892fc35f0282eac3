"""Reads an exported component library with pelicun, and prints its probabilities of exceedance and of damage states as JSON.

    python pelicun_damage.py FOLDER DEMAND UNIT SAMPLES LEVEL...

DEMAND is pelicun's word, such as PGV, at levels in UNIT. Each component stands on the first storey in direction 1. `exceedance` has
the probability of each limit state at each level, from the capacities that pelicun draws from; `damage` the fractions of the damage
states in an assessment of SAMPLES realizations per level. Runs in an environment of its own: requirements-pelicun.txt.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from pelicun.assessment import Assessment
from pelicun.file_io import load_data


def main(folder, demand, unit, samples, *levels):
    samples, levels = int(samples), [float(level) for level in levels]
    metadata = json.loads((Path(folder) / "fragility.json").read_text())
    found = {"described": sorted(set(metadata) - {"_GeneralInformation"}), "exceedance": {}, "damage": []}
    for level in levels:
        assessment = Assessment({"PrintLog": False, "Seed": 1, "NonDirectionalMultipliers": {"ALL": 1.2}})
        library = load_data(
            str(Path(folder) / "fragility.csv"), reindex=False, unit_conversion_factors=assessment.unit_conversion_factors
        )
        assessment.stories = 1
        # pelicun's floor under the components of the first storey is number 0; demands of the ground have the storey's number.
        place = 0 if demand in ("PFA", "PFV") else 1
        rows = {f"1-{demand}-{place}-1": [unit, *[level] * samples]}
        assessment.demand.load_sample(pd.DataFrame(rows, index=["Units", *range(samples)]))
        one = {"Units": "ea", "Location": "1", "Direction": "1", "Theta_0": "1", "Blocks": "1"}
        components = list(library.index)
        assessment.asset.load_cmp_model({"marginals": pd.DataFrame([one] * len(components), index=pd.Index(components, name="ID"))})
        assessment.asset.generate_cmp_sample(samples)
        assessment.damage.load_model_parameters([library], set(components))
        assessment.damage.calculate()
        fractions = assessment.damage.ds_model.probabilities().fillna(0.0)
        found["damage"].append({index[0]: row.to_dict() for index, row in fractions.iterrows()})
        groups = pd.MultiIndex.from_tuples([(component, "1", "1", "0") for component in components])
        capacities, _ = assessment.damage.ds_model._create_dmg_RVs(pd.DataFrame({"Blocks": 1}, index=groups))
        at = level * assessment.unit_conversion_factors[unit]
        for name, capacity in capacities.RV.items():
            _, component, *_, limit_state = name.split("-")
            states = found["exceedance"].setdefault(component, {})
            states.setdefault(limit_state, []).append(float(capacity.cdf(np.array([at]))[0]))
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
