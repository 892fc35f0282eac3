// The engine in a worker: a request and its bytes → the reply of WebAssembly.

let engine = null;

/**
 * Starts the engine. The drawing library imports functions of web pages that are never called here; without them the module
 * would not start.
 */
export function start(module) {
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] = () => {
      throw new Error(`${name} is not there`);
    };
  }
  return new WebAssembly.Instance(module, imports).exports;
}

/** Calls the engine; returns the reply's JSON and the bytes that follow it. */
export function call(exports, request, bytes = new Uint8Array()) {
  const json = new TextEncoder().encode(JSON.stringify(request));
  const at = exports.rocking_input(4 + json.length + bytes.length);
  const input = new Uint8Array(exports.memory.buffer, at, 4 + json.length + bytes.length);
  new DataView(exports.memory.buffer).setUint32(at, json.length, true);
  input.set(json, 4);
  input.set(bytes, 4 + json.length);
  const length = exports.rocking_call();
  const from = exports.rocking_output();
  const size = new DataView(exports.memory.buffer).getUint32(from, true);
  const reply = JSON.parse(new TextDecoder().decode(new Uint8Array(exports.memory.buffer, from + 4, size)));
  return { reply, buffer: exports.memory.buffer.slice(from + 4 + size, from + length) };
}

if (typeof WorkerGlobalScope !== "undefined") {
  self.onmessage = ({ data }) => {
    if (data.module) {
      engine = start(data.module);
      return;
    }
    const { id, request, bytes } = data;
    try {
      const { reply, buffer } = call(engine, request, bytes);
      self.postMessage({ id, reply, buffer }, [buffer]);
    } catch (error) {
      self.postMessage({ id, failure: String(error.message ?? error) });
    }
  };
}
