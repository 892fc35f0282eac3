"""The schemas of study files accept what the program reads, and refuse what it refuses."""

import json
import re
import subprocess
import tomllib

import jsonschema
import pytest
from conftest import ROOT

STUDIES = sorted(path for path in (ROOT / "examples").rglob("*.toml") if "fit" not in path.parts)
TESTS = sorted((ROOT / "examples/fit").glob("*.toml"))
RECORD = ROOT / "examples/records/np01002p_4225a_a.smc"

# A valid file for the tables of each kind.
STUDY = {
    "study": {"design": "grid", "scales": [1.0]},
    "parameters": {"foundation": "rigid"},
    "records": [{"horizontal": str(RECORD)}],
    "assess": {"title": "Block"},
}
VARIANTS = [
    {},
    {"study": {"design": "latin-hypercube", "samples": 2, "seed": 1, "scales": [1.0]}},
    {"study": {"design": "grid", "levels": {"im": "PGV", "values": [1.0]}}},
    {"study": {"design": "grid", "hunt": {"im": "PGV", "first": 1.0}}},
    {"study": {"design": "grid", "least": {"im": "PGV", "from": 1.0, "to": 2.0, "points": 3, "resolution": 0.5}}},
    {"study": {"design": "grid", "scales": [1.0], "ensemble": {"samples": 2, "seed": 1, "scale": 0.1, "alpha": 0.1}}},
    {
        "study": {"design": "grid", "scales": [1.0], "half_cycles": 0.01},
        "parameters": {"foundation": "rigid", "mass": 1000.0, "damper_1": {"ground_z": -1.0, "stiffness": 1e5, "yield_force": 1e3}},
    },
    {"parameters": {"alpha": {"from": 0.1, "to": 0.2, "count": 2}}},
    {
        "study": {"design": "grid", "scales": [1.0], "azimuths": {"count": 2, "seed": 1}},
        "parameters": {"depth_ratio": 1.5, "kappa": {"from": 0.5, "to": 1.0, "count": 2}, "initial": {"twist": 0.01}},
        "records": [{"x": str(RECORD), "y": str(ROOT / "examples/space/np01002p_4225c_a.smc"), "cut": True, "y_channel": 1}],
    },
    {"building": {"floor_masses": [1e5, 1e5], "storey_stiffnesses": [1e8, 1e8], "rayleigh": {"damping": 0.05, "modes": [1, 2]}}},
    {"assess": {"title": "Block", "hazard": {"file": str(ROOT / "examples/hazard.csv")}}},
    {"assess": {"title": "Block", "states": [{"name": "rocks", "limit": 0.1}]}},
    {"assess": {"title": "Block", "variants": [{"name": "wider", "width": 1.2}]}},
]

# Keys with further limits: the least levels end above their beginning, and two modes differ.
OF_OTHERS = {"to", "modes"}


@pytest.fixture(scope="module")
def schemas(program):
    def schema(kind):
        return json.loads(subprocess.run([program, "schema", kind], check=True, capture_output=True).stdout)

    return {kind: schema(kind) for kind in ("study", "fit")}


def written(value):
    """Returns a value as TOML on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {written(of)}" for key, of in value.items()) + " }"
    return json.dumps(value) if not isinstance(value, list) else "[" + ", ".join(map(written, value)) + "]"


def refusal(program, study, folder):
    """Returns the error of the program; a study whose runs have begun has none."""
    file = folder / "study.toml"
    file.write_text("".join(f"{key} = {written(value)}\n" for key, value in study.items()))
    command = [program, "assess", file, "--out", folder / "out"] if is_assessed(study) else [program, "sweep", file, "--csv", "-"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=0.5)
    except subprocess.TimeoutExpired:
        return ""
    return run.stderr if run.returncode else ""


def is_assessed(study):
    return study["assess"] != STUDY["assess"]


def resolved(schema, root):
    while "$ref" in schema:
        schema = root["$defs"][schema["$ref"].removeprefix("#/$defs/")]
    return schema


def around(schema):
    """Yields a refused and an accepted number at each limit of a schema, or of the items of a list."""
    if schema.get("type") == "array" and "items" in schema:
        count = schema.get("minItems", 1)
        yield from ([[found] * count for found in pair] for pair in around(schema["items"]))
    is_whole = schema.get("type") == "integer"
    for name, sign in {"minimum": 1, "exclusiveMinimum": 1, "maximum": -1, "exclusiveMaximum": -1}.items():
        if name in schema:
            limit = schema[name]
            step = sign * (1 if is_whole else 1e-9 * (abs(limit) or 1))
            yield [limit, limit + step] if name.startswith("exclusive") else [limit - step, int(limit) if is_whole else limit]


def leaves(schema, root, path=()):
    """Yields the paths of a schema's limited numbers, each with a number that it refuses and one that it accepts."""
    schema = resolved(schema, root)
    for key, of_key in schema.get("properties", {}).items():
        of_key = resolved(of_key, root)
        yield from leaves(of_key, root, (*path, key))
        for form in [of_key, *of_key.get("anyOf", [])]:
            yield from ((*path, key, *pair) for pair in around(resolved(form, root)))
    if schema.get("type") == "array":
        yield from leaves(schema["items"], root, (*path, 0))


def at(tree, path):
    for key in path:
        try:
            tree = tree[key]
        except (KeyError, IndexError, TypeError):
            return None
    return tree


def test_schemas_are_valid_and_those_beside_the_examples(schemas):
    for kind, schema in schemas.items():
        jsonschema.Draft202012Validator.check_schema(schema)
        assert json.loads((ROOT / f"examples/{kind}.schema.json").read_text()) == schema, f"rocking schema {kind} prints another one"


@pytest.mark.parametrize("path", STUDIES + TESTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_examples_name_their_schema_and_agree_with_it(path, schemas):
    kind = "fit" if path in TESTS else "study"
    first = path.read_text().splitlines()[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == ROOT / f"examples/{kind}.schema.json"
    jsonschema.validate(tomllib.loads(path.read_text()), schemas[kind])


def test_limits_are_those_of_the_program(program, schemas, tmp_path):
    """The program refuses a number just beyond a limit of the schema by the name of its key, and takes one just within it."""
    validator, tried = jsonschema.Draft202012Validator(schemas["study"]), 0
    for path in sorted(set(map(json.dumps, leaves(schemas["study"], schemas["study"])))):
        *path, key, beyond, within = json.loads(path)
        fitting = [variant for variant in VARIANTS if isinstance(at(STUDY | variant, path), dict)]
        # One that has the key, where there is one: others may have no use for it.
        variant = max(fitting, key=lambda variant: key in at(STUDY | variant, path), default=None)
        # The limits of parameters are those of the FMU's description.
        is_parameter = path[0] == "parameters" or (path[-1] == "ensemble" and key not in {"samples", "seed", "limits", "scale"})
        if variant is None or is_parameter:
            continue
        for value, is_refused in [(beyond, True), (within, False)]:
            study = json.loads(json.dumps(STUDY | variant))
            assert validator.is_valid(study), study
            at(study, path)[key] = value
            assert validator.is_valid(study) != is_refused, (path, key, value)
            found = re.search(rf"\b{key}( = .*; expected| expects) ", refusal(program, study, tmp_path))
            assert bool(found) == (is_refused or key in OF_OTHERS), (path, key, value, found)
        tried += 1
    assert tried > 40, tried


@pytest.mark.parametrize("wrong", [
    {"study": {"desing": "grid"}},
    {"study": {"design": "cube"}},
    {"parameters": {"alhpa": 0.2}},
    {"parameters": {"alpha": True}},
    {"parameters": {"alpha": 3.0}},
    {"parameters": {"pulse": {"shape": "two-sines"}}},
    {"parameters": {"friction": 0}},
    {"records": [{"horizontal": 3}]},
    {"records": []},
    {"study": {"design": "grid", "azimuths": "all"}},
    {"parameters": {"depth": 1.0, "feet": True}},
    {"assess": {"titel": "Block"}},
])
def test_both_refuse_a_mistake(program, schemas, wrong, tmp_path):
    study = STUDY | wrong
    assert list(jsonschema.Draft202012Validator(schemas["study"]).iter_errors(study))
    assert "expected" in refusal(program, study, tmp_path)
