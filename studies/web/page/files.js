// Dropped files → the slot of each: the horizontal record or the vertical one.

/** Parts of the names of vertical records, as in `RSN6_ELC-UP.AT2`, `AKT013.UD`, `IT.AQV..HNZ.D.ASC`. */
const VERTICAL = /^(u|v|z|up|dn|dwn|down|ud[12]?|ver|vert|vertical|[behs][ghln]z)$/i;

const isVertical = (name) => name.split(/[^a-z0-9]+/i).some((part) => VERTICAL.test(part));

/** The slots of files with these names, or a message; `on` is the slot on whose field they were dropped. */
export function slotsOf(names, on) {
  if (names.length === 1) return { slots: [on ?? "record"] };
  const vertical = names.map(isVertical);
  if (names.length === 2 && vertical[0] !== vertical[1]) return { slots: vertical.map((is) => (is ? "vertical" : "record")) };
  const listed = names.slice(0, 3).join(", ") + (names.length > 3 ? " and more" : "");
  return { message: `found ${names.length} files, ${listed}; expected one, or a horizontal and a vertical record, whose name has a part as UP, UD, V or Z` };
}

/** The dropped files, or a message if there is a folder among them. */
export function filesOf({ files, items }) {
  const entries = [...items].filter(({ kind }) => kind === "file").map((item) => item.webkitGetAsEntry?.());
  const folder = entries.find((entry) => entry?.isDirectory);
  return folder ? { message: `found the folder ${folder.name}; expected a file` } : { files: [...files] };
}

/** Marks the fields of files while files are dragged over the page, and gives those dropped to `take`, or a message to `refuse`. */
export function watchDrops(take, refuse) {
  const mark = (on) => document.querySelectorAll(".drop").forEach((drop) => drop.classList.toggle("over", on));
  for (const name of ["dragenter", "dragover"]) {
    addEventListener(name, (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      mark(true);
    });
  }
  addEventListener("dragleave", () => mark(false));
  addEventListener("drop", (event) => {
    mark(false);
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    const { files, message } = filesOf(event.dataTransfer);
    if (message) refuse(message);
    else take(files, event.target.closest?.("#field-vertical_file") ? "vertical" : undefined);
  });
}
