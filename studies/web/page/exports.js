// Tables, pictures, links and commands to take away.

import { $, element, say } from "./dom.js";

/** Rows of a table per request: the whole table of a long run may exceed the memory of the engine. */
const ROWS = 50_000;

export function save(name, type, content) {
  const link = element("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from files may lack the clipboard's permission.
    const area = document.body.appendChild(element("textarea", { value: text }));
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  $("copied").textContent = `${what} copied`;
  setTimeout(() => ($("copied").textContent = ""), 2500);
}

async function ask(engine, request) {
  const { reply, buffer } = await engine.call(request);
  if (!reply.ok) throw new Error(reply.errors.map(({ message }) => message).join(" · "));
  return { reply, buffer };
}

/** The table of the run that is shown, in pieces. */
async function table(engine, run) {
  const parts = [];
  for (let from = 0; from === 0 || from < run.rows; from += ROWS) {
    $("copied").textContent = from ? `table: ${Math.round((100 * from) / run.rows)} %` : "";
    const { buffer } = await ask(engine, { op: "csv", run: run.number, from, to: from + ROWS });
    parts.push(new Blob([buffer]));
  }
  return new Blob(parts);
}

/** Sets up the buttons for the table and the picture of a run; `recover` is called after a failure. */
export function setUpSaving(engine, currentRun, recover) {
  const makers = {
    csv: ["history.csv", "text/csv", (run) => table(engine, run)],
    svg: ["history.svg", "image/svg+xml", async (run) => (await ask(engine, { op: "svg", run: run.number })).buffer],
  };
  for (const [op, [name, type, make]] of Object.entries(makers)) {
    const button = $(`save-${op}`);
    button.addEventListener("click", async () => {
      button.disabled = true;
      say($("save-error"), "");
      try {
        const run = currentRun();
        if (!run) throw new Error("no run yet; expected one before its export");
        save(name, type, await make(run));
      } catch (error) {
        say($("save-error"), `${name} cannot be made: ${error.message}`);
        recover();
      }
      $("copied").textContent = "";
      button.disabled = false;
    });
  }
}
