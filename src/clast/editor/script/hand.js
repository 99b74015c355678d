/** What the hand does, sent to the server one after the other; of one gesture the newest alone. */

/** Sends edits and keeps the newest answer; `ask` posts to the server, `show` is told of each answer. */
export class Hand {
  constructor(ask, show) {
    Object.assign(this, { ask, show, version: 0, waiting: [], isBusy: false, looksOn: false, latency: [] });
  }

  /** Send edits; edits of the same gesture at the same place replace those that still wait. */
  edit(edits, gesture = "") { return this.change("/edit", edits, gesture); }

  /** The same while a slider moves: the answer has the lines of the joints. */
  move(edits, gesture) { return this.change("/move", edits, gesture); }

  change(path, edits, gesture) {
    return this.send(path, { edits, gesture }, gesture && `${gesture} ${edits.map((one) => JSON.stringify(one.place))}`);
  }

  undo() { return this.send("/undo", {}); }
  redo() { return this.send("/redo", {}); }
  text(text, gesture) { return this.send("/text", { text, gesture }, gesture); }

  send(path, body, like = "") {
    if (this.looksOn) return Promise.resolve(false);
    return new Promise((done) => {
      const asked = { path, body, like, done, begun: performance.now() }, last = this.waiting.at(-1);
      if (like && last?.like === like) this.waiting.pop().done(false);
      this.waiting.push(asked);
      this.next();
    });
  }

  async next() {
    if (this.isBusy || !this.waiting.length) return;
    this.isBusy = true;
    const { path, body, done, begun } = this.waiting.shift();
    let isDone = false;
    try {
      const answer = await this.ask(path, { ...body, version: this.version });
      isDone = !answer.refused;
      if (answer.version !== undefined) this.version = answer.version;
      this.show(answer);
    } catch (error) {
      this.show({ refused: `the editor does not answer: ${error.message}` });
    }
    this.latency.push(performance.now() - begun);
    this.isBusy = false;
    done(isDone);
    this.next();
  }
}
