// The time that is shown: by the slider, by clicks into plots, or as it passes.

import { $ } from "./dom.js";

/** Shows a run at a time in the scene and the plots. */
export class Player {
  #run = null;
  #time = 0;
  #playing = false;
  /** Whether the user has chosen a time, and whether the motion was ever shown. */
  #chosen = false;
  #played = false;
  #last = 0;

  constructor(scene, histories) {
    this.scene = scene;
    this.histories = histories;
    $("play").addEventListener("click", () => this.toggle());
    $("time").addEventListener("input", () => {
      this.#played = true;
      this.seek(Number($("time").value));
    });
  }

  /** Shows a new run: at its greatest tilt until the user has chosen a time. */
  show(run) {
    this.#run = run;
    const { t, theta = run.series.tilt } = run.series;
    [$("time").min, $("time").max] = [t[0], t[t.length - 1]];
    this.#setTime(this.#playing || this.#chosen ? this.#time : t[indexOfPeak(theta)]);
  }

  /** Shows a time that the user chose (s). */
  seek(time) {
    this.#chosen = true;
    this.#setTime(time);
  }

  toggle() {
    this.#play(!this.#playing);
  }

  /** Stops, and shows the next run at its greatest tilt. */
  reset() {
    this.#chosen = this.#played = false;
    this.#play(false);
  }

  #setTime(value) {
    if (!this.#run) return;
    const { series, broken } = this.#run;
    const { t } = series;
    const time = (this.#time = Math.min(Math.max(value, t[0]), t[t.length - 1]));
    const [low, high] = around(t, time);
    const part = t[high] > t[low] ? (time - t[low]) / (t[high] - t[low]) : 0;
    const at = (name) => series[name][low] + part * (series[name][high] - series[name][low]);
    const pose = Object.fromEntries(this.scene.series.map((name) => [name, at(name)]));
    this.scene.pose({ ...pose, broken: broken?.map((at) => at !== null && at <= time) });
    if (!this.#run.in_space) this.histories.setTime(time);
    $("time").value = time;
    $("time").setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
    $("clock").textContent = `${time.toFixed(2)} s`;
  }

  #play(on) {
    this.#playing = on && this.#run !== null;
    $("play").textContent = this.#playing ? "Pause" : "Play";
    $("play").setAttribute("aria-pressed", String(this.#playing));
    if (!this.#playing) return;
    this.#chosen = true;
    const { t } = this.#run.series;
    if (this.#time >= t[t.length - 1] - 1e-6 || !this.#played) this.#setTime(t[0]);
    this.#played = true;
    this.#last = performance.now();
    requestAnimationFrame((now) => this.#frame(now));
  }

  #frame(now) {
    if (!this.#playing) return;
    const { t } = this.#run.series;
    this.#setTime(this.#time + (Math.min(now - this.#last, 100) / 1000) * Number($("speed").value));
    this.#last = now;
    if (this.#time >= t[t.length - 1]) return this.#play(false);
    requestAnimationFrame((next) => this.#frame(next));
  }
}

/** The neighbours of a time in `t`. */
function around(t, time) {
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return [low, high];
}

function indexOfPeak(theta) {
  let best = 0;
  for (let i = 1; i < theta.length; i++) if (Math.abs(theta[i]) > Math.abs(theta[best])) best = i;
  return best;
}
