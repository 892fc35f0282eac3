"""A bridge deck on two rocking towers in an earthquake: an SSP package, run by libcosim and Ecos.

    python examples/coupling/bridge/bridge.py

Writes bridge.png to the working directory (with --update, result.png beside this file), and bridge.ssp to the
folder given as argument, if any.
"""

import sys
import tempfile
import zipfile
from itertools import product
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))
from common import BLOCK, Instance, load_tbb, parser, picture, read_record

MOTIONS = ("u", "u_dot", "v", "v_dot", "theta", "theta_dot")
FORCES = ("F_x", "F_z", "M_y")
DECK_WEIGHT = 300e3 * 9.81  # N
MASS, OMEGA = 200e3, 40.0  # of a tower: kg, and rad/s of its vertical motion on the soil


def tower(width: float, height: float = 12.0) -> dict:
    """Returns the dimensionless parameters of a tower of this width and height [m]."""
    radius = np.hypot(width, height) / 2
    p = np.sqrt(0.75 * 9.81 / radius)
    return {
        "dimensionless.alpha": float(np.arctan2(width, height)),
        "dimensionless.p": float(p),
        "dimensionless.eta": float(OMEGA / p),
        "dimensionless.xi_v": 0.1,
        "mass": MASS,
        # At rest under half of the deck; 0 would be at rest under its own weight.
        "initial.settled": False,
        "initial.v": -DECK_WEIGHT / 2 / (MASS * OMEGA**2),
    }


# Two towers on the same soil. The second is slenderer, so that the deck transfers forces between them.
COMPONENTS = {
    "ground": ("Ground.fmu", {}),
    "deck": ("Deck.fmu", {}),
    "tower_1": ("RockingBlock.fmu", tower(3.0)),
    "tower_2": ("RockingBlock.fmu", tower(2.4)),
}
CONNECTIONS = (
    [("ground", "a", sink, "a_gx") for sink in ("deck", "tower_1", "tower_2")]
    + [(f"tower_{i}", name, "deck", f"{name}_{i}") for i, name in product((1, 2), MOTIONS)]
    + [("deck", f"{name}_{i}", f"tower_{i}", name) for i, name in product((1, 2), FORCES)]
)
TOWER_OUTPUTS = ("theta", "u", "energy.input", "energy.impacts")
WATCHED = {"ground": ("a",), "deck": ("x", "F_x_1", "F_x_2", "work"), "tower_1": TOWER_OUTPUTS, "tower_2": TOWER_OUTPUTS}


def earthquake(scale: float = 2.0, begin: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    """Returns times [s] and accelerations [m/s2]: the record times `scale`, from `begin` [s] on, which rises from zero in 0.2 s."""
    time, record = read_record()
    samples = scale * record[round(begin / time[1]) :]
    rise = round(0.2 / time[1])
    samples[:rise] *= np.linspace(0, 1, rise)
    return time[: len(samples)], samples


def build_ground(folder, time: np.ndarray, samples: np.ndarray) -> Path:
    """Builds the FMU of an earthquake."""
    from pythonfmu.builder import FmuBuilder

    file = Path(folder, "record.csv")
    file.write_text("\n".join(map(repr, map(float, [time[1], *samples]))))
    return FmuBuilder.build_FMU(HERE / "ground.py", dest=folder, project_files=[file], canHandleVariableCommunicationStepSize=True)


def build_parts(folder) -> dict[str, Path]:
    """Builds the FMUs of the package."""
    from pythonfmu.builder import FmuBuilder

    return {
        "Deck.fmu": FmuBuilder.build_FMU(HERE / "deck.py", dest=folder, canHandleVariableCommunicationStepSize=True),
        "Ground.fmu": build_ground(folder, *earthquake()),
        "RockingBlock.fmu": Path(BLOCK),
    }


def system_structure() -> str:
    """Returns SystemStructure.ssd of the package (SSP 1.0)."""
    elements = []
    for name, (source, values) in COMPONENTS.items():
        kinds = {variable: "output" for component, variable, _, _ in CONNECTIONS if component == name}
        kinds |= {variable: "output" for variable in WATCHED.get(name, ())}
        kinds |= {variable: "input" for _, _, component, variable in CONNECTIONS if component == name}
        connectors = "".join(f'<ssd:Connector name={quoteattr(variable)} kind="{kind}"><ssc:Real/></ssd:Connector>'
                             for variable, kind in kinds.items())
        types = {bool: "Boolean", float: "Real"}
        parameters = "".join(
            f'<ssv:Parameter name={quoteattr(variable)}><ssv:{types[type(value)]} value="{str(value).lower()}"/></ssv:Parameter>'
            for variable, value in values.items())
        binding = (f'<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>'
                   f'<ssv:ParameterSet version="1.0" name="initialValues"><ssv:Parameters>{parameters}</ssv:Parameters>'
                   f'</ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>')
        elements.append(f'<ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" source="resources/{source}">'
                        f'<ssd:Connectors>{connectors}</ssd:Connectors>{binding if values else ""}</ssd:Component>')
    connections = "".join(
        f'<ssd:Connection startElement="{a}" startConnector="{b}" endElement="{c}" endConnector="{d}"/>'
        for a, b, c, d in CONNECTIONS)
    return ('<?xml version="1.0" encoding="UTF-8"?>'
            '<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" '
            'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
            'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" name="bridge" version="1.0">'
            f'<ssd:System name="bridge"><ssd:Elements>{"".join(elements)}</ssd:Elements>'
            f'<ssd:Connections>{connections}</ssd:Connections></ssd:System>'
            '<ssd:DefaultExperiment startTime="0" stopTime="10"/></ssd:SystemStructureDescription>')


def build_ssp(folder, parts: dict[str, Path]) -> Path:
    path = Path(folder) / "bridge.ssp"
    with zipfile.ZipFile(path, "w") as package:
        package.writestr("SystemStructure.ssd", system_structure())
        for name, part in parts.items():
            package.write(part, f"resources/{name}")
    return path


def columns(rows, watched=WATCHED) -> dict[str, np.ndarray]:
    names = [f"{component}.{name}" for component, names in watched.items() for name in names]
    return dict(zip(names, np.array(rows).T, strict=True))


def run_libcosim(ssp, h: float, stop: float, watched=WATCHED) -> dict[str, np.ndarray]:
    """Runs the package in libcosim with fixed steps of `h` [s]; returns the watched variables after each step."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(str(ssp), round(1e9 * h))  # ns
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    indices = {component: execution.slave_index_from_instance_name(component) for component in watched}
    references = {}
    for component, names in watched.items():
        known = {variable.name.decode(): variable.reference for variable in execution.slave_variables(indices[component])}
        references[component] = [known[name] for name in names]
    rows = []
    for _ in range(round(stop / h)):
        if not execution.step():
            raise RuntimeError("libcosim stopped")
        rows.append([value for component in watched
                     for value in observer.last_real_values(indices[component], references[component])])
    return columns(rows, watched)


def run_ecos(ssp, h: float, stop: float, watched=WATCHED) -> dict[str, np.ndarray]:
    """Runs the package in Ecos with fixed steps of `h` [s]; returns the watched variables after each step."""
    load_tbb()
    from ecospy import EcosSimulation

    rows = []
    with EcosSimulation(ssp_path=str(ssp), step_size=h) as simulation:
        simulation.init(parameter_set="initialValues")
        for _ in range(round(stop / h)):
            simulation.step()
            rows.append([simulation.get_real(f"{component}::{name}") for component, names in watched.items() for name in names])
        simulation.terminate()
    return columns(rows, watched)


def run_fmpy(parts: dict[str, Path], h: float, stop: float) -> dict[str, np.ndarray]:
    """Runs the same exchange in a few lines of Python: every FMU steps with the others' outputs from the start of the step."""
    opened = {name: Instance(parts[source], values, initialize=False) for name, (source, values) in COMPONENTS.items()}

    def exchange():
        for source, output, sink, name in CONNECTIONS:
            opened[sink].set(**{name: opened[source].get(output)[0]})

    exchange()
    for part in opened.values():
        part.slave.exitInitializationMode()
    rows = []
    for k in range(round(stop / h)):
        exchange()
        for part in opened.values():
            part.slave.doStep(k * h, h)
        rows.append([value for component, names in WATCHED.items() for value in opened[component].get(*names)])
    for part in opened.values():
        part.close()
    return columns(rows)


def missing(run: dict[str, np.ndarray]) -> float:
    """Returns the largest difference of the energy received by the towers and given by the deck.

    It is relative to the largest input of the ground into a tower. The towers' sums include the work of the ground, whose
    acceleration was held over each step.
    """
    acceleration = np.concatenate(([0.0], run["ground.a"][:-1]))
    got, scale = 0.0, 0.0
    for tower in ("tower_1", "tower_2"):
        ground = np.cumsum(-MASS * acceleration * np.diff(run[f"{tower}.u"], prepend=0.0))
        got, scale = got + run[f"{tower}.energy.input"] - ground, max(scale, np.abs(ground).max())
    return np.abs(got - run["deck.work"]).max() / scale


def plot(h: float, runs: dict[str, dict[str, np.ndarray]], path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axes = plt.subplots(3, 1, figsize=(10, 8), layout="constrained", sharex=True)
    run = runs["libcosim"]
    time = h * np.arange(1, len(run["deck.x"]) + 1)
    axes[0].plot(time, run["ground.a"], lw=0.8, color="0.5")
    axes[0].set(ylabel="m/s²", title="Ground acceleration")
    axes[1].plot(time, run["tower_1.theta"], label="wide tower, libcosim")
    axes[1].plot(time, run["tower_2.theta"], label="slender tower, libcosim")
    for tower in ("tower_1", "tower_2"):
        axes[1].plot(time[::80], runs["ecos"][f"{tower}.theta"][::80], "k.", ms=4, label="ecos" if tower == "tower_1" else None)
    axes[1].set(ylabel="rad", title="Rotation of the towers")
    axes[2].plot(time, run["deck.F_x_1"] / 1e3, label="on the wide tower")
    axes[2].plot(time, run["deck.F_x_2"] / 1e3, label="on the slender tower")
    axes[2].set(xlabel="time [s]", ylabel="kN", title="Horizontal force of the deck")
    for axis in axes:
        axis.grid(alpha=0.3)
    for axis in axes[1:]:
        axis.legend(loc="lower left", fontsize=8)
    plt.savefig(path, dpi=90)


def main() -> None:
    options = parser(__doc__)
    options.add_argument("folder", nargs="?", help="where bridge.ssp is kept")
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or temporary
        parts = build_parts(temporary)
        ssp = build_ssp(folder, parts)
        h, stop = 0.002, 10.0
        runs = {"libcosim": run_libcosim(ssp, h, stop), "ecos": run_ecos(ssp, h, stop)}
        for name, run in runs.items():
            print(f"{name}: greatest rotation {np.abs(run['tower_1.theta']).max():.6f} and "
                  f"{np.abs(run['tower_2.theta']).max():.6f} rad, energy missing {100 * missing(run):.3f} %")
        print("greatest difference of the rotations:",
              max(np.abs(runs["libcosim"][name] - runs["ecos"][name]).max() for name in ("tower_1.theta", "tower_2.theta")), "rad")
        plot(h, runs, picture(arguments, HERE))


if __name__ == "__main__":
    main()
