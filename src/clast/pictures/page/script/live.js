// A run that goes on: frames come from the server of the page, and buttons lead the run.

const AGAIN = 1000;

/** The server that the page has come from. */
export class Live {
  /** @param {string} token what it knows the page by */
  constructor(token) {
    // within the window of an editor requests are that window's
    this.headers = { Authorization: `Bearer ${token}`, Window: sessionStorage.getItem("window") ?? "" };
    this.next = 0;
    this.status = {};
  }

  async ask(path, more = {}) {
    const answer = await fetch(path, { headers: this.headers, cache: "no-store", ...more });
    if (!answer.ok) {
      const fault = new Error(await answer.text());
      fault.status = answer.status;
      throw fault;
    }
    return answer;
  }

  /** Return the scene of what there is, as soon as there is something. */
  async scene() {
    for (;;) {
      const scene = await (await this.ask("/scene")).json();
      if (scene) {
        this.next = scene.next;
        this.status = scene.status;
        return scene;
      }
      await later(AGAIN / 4);
    }
  }

  /** Ask the run to pause, go, step, end, or write a checkpoint. */
  do(what) {
    return this.ask("/do", { method: "POST", body: JSON.stringify({ do: what }) });
  }

  /** Return the file of the page. */
  async file() {
    return (await this.ask("/page")).blob();
  }

  /**
   * Call back with what is new; the server knows by it that somebody looks on, after the end too.
   * @param {Record<string, (data: any) => any>} hear called by the kind of news
   */
  async follow(hear) {
    for (;;) {
      try {
        const { body } = await this.ask(`/events?from=${this.next}`);
        for await (const [kind, data] of eventsOf(body)) {
          const news = JSON.parse(data);
          if (kind === "frames") this.next = news.next;
          if (kind === "status") this.status = news;
          await hear[kind]?.(news);
        }
      } catch (fault) {
        if (fault.status && fault.status !== 503) throw fault;
      }
      if (this.status.over) return;
      await hear.gone?.();
      await later(AGAIN);
    }
  }
}

/** Give kind and data of events as they come. */
async function* eventsOf(stream) {
  const reader = stream.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    text += value;
    const events = text.split("\n\n");
    text = events.pop();
    for (const event of events) {
      const lines = event.split("\n");
      const of = (name) => lines.find((line) => line.startsWith(`${name}: `))?.slice(name.length + 2);
      yield [of("event"), of("data")];
    }
  }
}

function later(milliseconds) {
  return new Promise((done) => setTimeout(done, milliseconds));
}
