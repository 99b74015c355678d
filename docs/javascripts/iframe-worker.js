// Browsers start no worker for a page that was opened from the disk: the script of the search runs in a
// frame of the page instead.  The builder of the site would otherwise fetch the like from another host.
if (location.protocol === "file:") {
  window.Worker = class {
    constructor(address) {
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      const { contentWindow: within, contentDocument } = this.frame;
      within.postMessage = (data) => this.onmessage?.({ data });
      const script = contentDocument.createElement("script");
      script.src = new URL(address, location.href).href;
      this.ready = new Promise((done) => (script.onload = done));
      script.onerror = () => this.onerror?.(new Event("error"));
      contentDocument.body.append(script);
      this.within = within;
    }

    postMessage(data) {
      this.ready.then(() => this.within.onmessage?.({ data }));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
