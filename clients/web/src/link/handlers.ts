// SPDX-License-Identifier: Apache-2.0

/** Who wants to hear of which topic: exact ("floor/cop"), or everything of a rig ("floor/"). */
export class Handlers<Message> {
  #byTopic = new Map<string, Set<(message: Message) => void>>();

  add(topic: string, handler: (message: Message) => void): () => void {
    const handlers = this.#byTopic.get(topic) ?? new Set();
    this.#byTopic.set(topic, handlers);
    // An entry of its own, so that the same function may be added twice.
    const entry = (message: Message): void => handler(message);
    handlers.add(entry);
    return () => {
      handlers.delete(entry);
      if (handlers.size === 0 && this.#byTopic.get(topic) === handlers) this.#byTopic.delete(topic);
    };
  }

  tell(topic: string, message: Message): void {
    this.#tellOf(topic, message);
    this.#tellOf(topic.slice(0, topic.indexOf('/') + 1), message);
  }

  // A handler that fails spoils neither the other ones nor the connection.
  #tellOf(topic: string, message: Message): void {
    for (const handler of this.#byTopic.get(topic) ?? []) {
      try {
        handler(message);
      } catch (problem) {
        reportError(problem);
      }
    }
  }
}
