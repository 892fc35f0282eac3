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
  // The next call tries again.
  compiled.catch(() => (compiled = null));
  return compiled;
}

/** The reply to a call that the engine did not answer. */
const failed = (message) => ({ reply: { ok: false, errors: [{ field: "run", message }] }, buffer: new ArrayBuffer(0) });

/** An engine in a worker. After a failure, the next call starts it anew. */
export class Engine {
  #worker = null;
  #waiting = new Map();
  #next = 0;
  #files = new Map();

  async #start() {
    const module = await moduleOfPage();
    if (this.#worker) return;
    const url = URL.createObjectURL(new Blob([WORKER_SOURCE], { type: "text/javascript" }));
    const worker = (this.#worker = new Worker(url));
    URL.revokeObjectURL(url);
    worker.onmessage = ({ data }) => {
      if (worker !== this.#worker) return;
      // After a trap the memory of the engine is in doubt.
      if (data.failure !== undefined) return this.#fail(data.failure);
      this.#waiting.get(data.id)(data);
      this.#waiting.delete(data.id);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      if (worker === this.#worker) this.#fail(event.message);
    };
    worker.postMessage({ module });
    for (const [slot, { name, bytes }] of this.#files) this.#post({ op: "file", slot, name }, bytes);
  }

  /** Ends the worker and answers all calls with the failure. */
  #fail(failure) {
    this.#worker.terminate();
    this.#worker = null;
    for (const resolve of this.#waiting.values()) resolve(failed(`the engine stopped: ${failure}; the next change starts it again`));
    this.#waiting.clear();
  }

  #post(request, bytes) {
    const id = this.#next++;
    return new Promise((resolve) => {
      this.#waiting.set(id, resolve);
      this.#worker.postMessage({ id, request, bytes });
    });
  }

  /** Sends a request; resolves with its reply, or with the failure of the engine. */
  async call(request, bytes) {
    try {
      await this.#start();
      return await this.#post(request, bytes);
    } catch (error) {
      return failed(`the engine does not start: ${error.message}; the next change tries again`);
    }
  }

  /** Gives a file to the engine, now and after each new start. */
  setFile(slot, name, bytes) {
    this.#files.set(slot, { name, bytes });
    if (this.#worker) this.#post({ op: "file", slot, name }, bytes);
  }
}

/** Makes the rows of a study in pieces on several engines; `piece` receives the rows as they are made, until `signal` is aborted. */
export async function study(engines, prepare, signal, piece, progress) {
  const prepared = await Promise.all(engines.map((engine) => engine.call(prepare)));
  const { reply } = prepared.find(({ reply }) => !reply.ok) ?? prepared[0];
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
        if (signal.aborted) return;
        if (!made.reply.ok) throw new Error(made.reply.errors[0].message);
        lines[from / ROWS] = new TextDecoder().decode(made.buffer);
        done += made.reply.rows;
        piece(reply, from, made.reply.columns);
        progress(done, reply.rows);
      }
    }),
  );
  return { ...reply, complete: done === reply.rows, table: reply.header + lines.join("") };
}
