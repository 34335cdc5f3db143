// SPDX-License-Identifier: Apache-2.0

/** Handlers by topic: exact ("floor/cop"), or everything of a rig ("floor/"). */
export class Handlers<Message> {
  #byTopic = new Map<string, Set<(message: Message) => void>>();

  add(topic: string, handler: (message: Message) => void): () => void {
    const handlers = this.#byTopic.get(topic) ?? new Set();
    this.#byTopic.set(topic, handlers);
    // A new function, so that the same handler can be added twice.
    const entry = (message: Message): void => handler(message);
    handlers.add(entry);
    return () => {
      handlers.delete(entry);
      if (handlers.size === 0 && this.#byTopic.get(topic) === handlers) this.#byTopic.delete(topic);
    };
  }

  deliver(topic: string, message: Message): void {
    this.#deliverTo(topic, message);
    this.#deliverTo(topic.slice(0, topic.indexOf('/') + 1), message);
  }

  // A handler that throws must disturb neither other handlers nor the connection.
  #deliverTo(topic: string, message: Message): void {
    for (const handler of this.#byTopic.get(topic) ?? []) {
      try {
        handler(message);
      } catch (problem) {
        reportError(problem);
      }
    }
  }
}
