// Engines in workers: one for the run that is shown, others for studies in the background.

let compiled = null;

/** Unpacks and compiles the engine once; workers share the compiled module. */
function moduleOfPage() {
  compiled ??= (async () => {
    const text = document.getElementById("engine").textContent;
    const packed = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  })();
  return compiled;
}

export class Engine {
  #worker = null;
  #waiting = new Map();
  #next = 0;
  #files = new Map();

  async #start() {
    const module = await moduleOfPage();
    if (this.#worker) return;
    const url = URL.createObjectURL(new Blob([WORKER_SOURCE], { type: "text/javascript" }));
    this.#worker = new Worker(url);
    URL.revokeObjectURL(url);
    this.#worker.onmessage = ({ data }) => {
      const { resolve } = this.#waiting.get(data.id);
      this.#waiting.delete(data.id);
      if (data.failure === undefined) return resolve(data);
      // After a trap the memory of the engine is in doubt: begin again.
      this.stop();
      const message = `the engine stopped: ${data.failure}; expected a reply`;
      resolve({ reply: { ok: false, errors: [{ field: "run", message }] }, buffer: new ArrayBuffer(0) });
    };
    this.#worker.postMessage({ module });
    for (const [slot, { name, bytes }] of this.#files) this.#post({ op: "file", slot, name }, bytes);
  }

  #post(request, bytes) {
    const id = this.#next++;
    return new Promise((resolve) => {
      this.#waiting.set(id, { resolve });
      this.#worker.postMessage({ id, request, bytes });
    });
  }

  /** Sends a request; resolves with its reply. */
  async call(request, bytes) {
    await this.#start();
    return this.#post(request, bytes);
  }

  /** Gives a file to the engine, now and after each new start. */
  setFile(slot, name, bytes) {
    this.#files.set(slot, { name, bytes });
    return this.#worker ? this.#post({ op: "file", slot, name }, bytes) : undefined;
  }

  stop() {
    this.#worker?.terminate();
    this.#worker = null;
    for (const { resolve } of this.#waiting.values()) resolve(null);
    this.#waiting.clear();
  }
}

/** Makes the rows of a study in pieces on several engines; `piece` receives the rows as they are made, until `signal` is aborted. */
export async function study(engines, prepare, signal, piece, progress) {
  const prepared = await Promise.all(engines.map((engine) => engine.call(prepare)));
  const { reply } = prepared[0];
  if (!reply.ok) return reply;
  const ROWS = 4;
  let next = 0;
  let done = 0;
  const lines = new Array(Math.ceil(reply.rows / ROWS));
  await Promise.all(
    engines.map(async (engine) => {
      while (next < reply.rows && !signal.aborted) {
        const from = next;
        next += ROWS;
        const made = await engine.call({ op: "rows", from, to: Math.min(from + ROWS, reply.rows) });
        if (!made || signal.aborted) return;
        if (!made.reply.ok) throw new Error(made.reply.errors[0].message);
        lines[from / ROWS] = new TextDecoder().decode(made.buffer);
        done += made.reply.fields.length;
        piece(reply, from, made.reply.fields);
        progress(done, reply.rows);
      }
    }),
  );
  return { ...reply, complete: done === reply.rows, table: reply.header + lines.join("") };
}
