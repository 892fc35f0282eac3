// Dropped files → the slot of each: the horizontal record, in space that along y, or the vertical one.

/** Parts of the names of vertical records, as in `RSN6_ELC-UP.AT2`, `AKT013.UD`, `IT.AQV..HNZ.D.ASC`. */
const VERTICAL = /^(u|v|z|up|dn|dwn|down|ud[12]?|ver|vert|vertical|[behs][ghln]z)$/i;

const isVertical = (name) => name.split(/[^a-z0-9]+/i).some((part) => VERTICAL.test(part));

/**
 * The slots of files with these names, or a message; `on` is the slot on whose field they were dropped. In space the horizontal files are
 * those along x and y in the order of their names.
 */
export function slotsOf(names, on, isInSpace) {
  if (names.length === 1) return { slots: [on ?? "record"] };
  const horizontal = names.filter((name) => !isVertical(name)).sort();
  const verticals = names.length - horizontal.length;
  const slots = ["record", "record_y"].slice(0, isInSpace ? 2 : 1);
  if (verticals <= 1 && horizontal.length > 0 && horizontal.length <= slots.length) {
    return { slots: names.map((name) => slots[horizontal.indexOf(name)] ?? "vertical") };
  }
  const records = isInSpace ? "one or two horizontal records and perhaps a vertical one" : "one, or a horizontal and a vertical record";
  const listed = names.slice(0, 3).join(", ") + (names.length > 3 ? " and more" : "");
  return { message: `found ${names.length} files, ${listed}; expected ${records}, whose name has a part as UP, UD, V or Z` };
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
    else take(files, ["vertical", "record_y"].find((slot) => event.target.closest?.(`#field-${slot}_file`)));
  });
}
