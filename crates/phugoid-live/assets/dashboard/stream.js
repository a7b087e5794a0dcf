// Where documents come from: the events of the server, or data inside the page.
"use strict";

// Without an estimate for so long, ms, while the stream is open, what is shown is called old.
const STALE_MS = 2000;

class Stream {
  // `take` gets each document; `fail` what could not be read.
  constructor(take, fail) {
    this.take = take;
    this.fail = fail;
    this.state = "connecting";
    this.attempts = 0;
    this.estimateAt = NaN;
    this.heardAt = NaN;
    this.brokenAt = NaN;
  }

  // The token in the page's address, if there is one, goes along.
  open(path) {
    const source = new EventSource(path + window.location.search);
    this.source = source;
    source.onopen = () => {
      this.state = "open";
      this.attempts = 0;
    };
    source.onerror = () => {
      if (this.state === "ended") return;
      if (this.state !== "broken") this.brokenAt = performance.now();
      this.state = "broken";
      this.attempts += 1;
      // The browser itself tries again unless the answer was no stream of events: then it is tried here.
      if (source.readyState === EventSource.CLOSED) {
        source.close();
        this.timer = setTimeout(() => this.open(path), 2000);
      }
    };
    source.onmessage = (message) => this.message(message.data);
  }

  message(data) {
    this.heardAt = performance.now();
    let document;
    try {
      document = JSON.parse(data);
    } catch (error) {
      this.fail(`phugoid sent a document that is no JSON: ${error.message}`);
      return;
    }
    if (document.type === "estimate") this.estimateAt = this.heardAt;
    try {
      this.take(document);
    } catch (error) {
      this.fail(`phugoid sent a document \`${document.type}\` that this page does not understand: ${error.message}`);
    }
    if (document.type === "end") {
      this.state = "ended";
      this.source.close();
    }
  }

  // Seconds since the last estimate.
  age() { return (performance.now() - this.estimateAt) / 1000; }

  isStale() { return this.state !== "ended" && performance.now() - this.estimateAt > STALE_MS; }
}
