// Search on pages opened from a disk, where browsers refuse workers: the theme's worker runs in a hidden frame instead.
(() => {
  if (location.protocol !== "file:") return;

  class FrameWorker extends EventTarget {
    constructor(script) {
      super();
      const frame = document.body.appendChild(Object.assign(document.createElement("iframe"), { hidden: true }));
      this.inside = frame.contentWindow;
      this.loaded = new Promise((resolve) => {
        const page = this.inside.document;
        // A worker's messages go to the page that made it, and it loads scripts in turn.
        this.inside.postMessage = (message) => this.receive(message);
        this.inside.importScripts = (...paths) => paths.reduce((before, path) => before.then(() => load(page, path)), Promise.resolve());
        load(page, script).then(resolve);
      });
    }

    receive(data) {
      const event = new MessageEvent("message", { data });
      this.dispatchEvent(event);
      this.onmessage?.(event);
    }

    postMessage(data) {
      this.loaded.then(() => this.inside.dispatchEvent(new this.inside.MessageEvent("message", { data: structuredClone(data) })));
    }

    terminate() {
      this.inside.frameElement.remove();
    }
  }

  const load = (page, path) =>
    new Promise((resolve, reject) => {
      const script = Object.assign(page.createElement("script"), { src: path, onload: resolve, onerror: reject });
      page.head.append(script);
    });

  window.Worker = FrameWorker;
})();
