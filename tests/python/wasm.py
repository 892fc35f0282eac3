"""An importer of the FMU for WebAssembly: its components in wasmtime, with the method names of fmpy's FMU3Slave and FMU3Model."""

import re
import zipfile
from functools import cache
from types import SimpleNamespace

import wasmtime
from wasmtime import component

PACKAGE = "fmi:fmi3/{}@3.0.0"
CO_SIMULATION = ("co-simulation", "rocking_block")
MODEL_EXCHANGE = ("model-exchange", "rocking_block_me")


class Refused(Exception):
    """A status of error or discard, with the messages of the call."""

    def __init__(self, status, messages):
        super().__init__(status, messages)
        self.status, self.messages = status, messages


@cache
def compiled(fmu, identifier):
    engine = wasmtime.Engine()
    with zipfile.ZipFile(fmu) as archive:
        return engine, component.Component(engine, archive.read(f"binaries/wasm32-wasip2/{identifier}.wasm"))


def token(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return re.search('instantiationToken="([^"]*)"', archive.read("modelDescription.xml").decode())[1]


class Instance:
    """An instance in a store of its own. `folder` is what the component sees as /records."""

    def __init__(self, fmu, kind=CO_SIMULATION, folder=None, on_update=None, name="block", given=None, logging=True, options=None):
        interface, identifier = kind
        engine, binary = compiled(fmu, identifier)
        self.messages, self.store = [], wasmtime.Store(engine)
        wasi = wasmtime.WasiConfig()
        if folder:
            wasi.preopen_dir(str(folder), "/records", fs_mutable=False)
        self.store.set_wasi(wasi)
        linker = component.Linker(engine)
        linker.add_wasip2()
        with linker.root() as root:
            with root.add_instance(PACKAGE.format("callbacks")) as callbacks:
                callbacks.add_func("log-message", lambda _, *message: self.messages.append(message))
            if interface == "co-simulation":
                with root.add_instance(PACKAGE.format("intermediate-update-callbacks")) as updates:
                    updates.add_func("intermediate-update", lambda _, *update: on_update(*update))
        self.instance = linker.instantiate(self.store, binary)
        self.index = self.instance.get_export_index(self.store, PACKAGE.format(interface))
        self.prefix, self.functions = f"[method]{interface}-instance.", {}
        make = self.function(f"[static]{interface}-instance.instantiate-{interface}")
        options = [False, False, []] if options is None else options
        given = token(fmu) if given is None else given
        arguments = [name, given, "", False, logging] + (options if kind is CO_SIMULATION else [])
        self.resource = make(self.store, *arguments)
        if self.resource is None:
            raise Refused(None, self.messages)
        if logging:
            self.setDebugLogging(False, ["logEvents", "logSteps"])

    def function(self, name):
        if name not in self.functions:
            export = self.instance.get_export_index(self.store, name, self.index)
            self.functions[name] = self.instance.get_func(self.store, export)
        return self.functions[name]

    def call(self, name, *arguments):
        """The result of a method, or `Refused`. A trap is an exception of wasmtime and fails the test."""
        self.messages.clear()
        result = self.function(self.prefix + name)(self.store, self.resource, *arguments)
        if result in ("error", "discard", "fatal"):
            raise Refused(result, list(self.messages))
        return None if result in ("ok", "warning") else result

    def __getattr__(self, name):
        """`getFloat64` is `get-float64`, and so on."""
        kebab = re.sub("(?<=[a-z0-9])(?=[A-Z])", "-", name.replace("FMU", "Fmu").replace("UInt", "Uint")).lower()
        return lambda *arguments: self.call(kebab, *arguments)

    def enterInitializationMode(self):
        self.call("enter-initialization-mode", None, 0.0, None)

    def doStep(self, time, size):
        """The tuple of fmpy's `doStep`."""
        step = SimpleNamespace(**{key.replace("-", "_"): value for key, value in vars(self.call("do-step", time, size, True)).items()})
        return step.event_handling_needed, step.terminate_simulation, step.early_return, step.last_successful_time
