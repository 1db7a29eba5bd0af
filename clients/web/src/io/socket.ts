/** A WebSocket that comes back: exponential back-off with jitter until it is stopped. */

const FIRST_MS = 500;
const LONGEST_MS = 10_000;
const STABLE_MS = 5_000;

export interface SocketEvents {
  open(): void;
  message(data: Uint8Array): void;
  /** The connection is gone; another try follows in `retryMs`. */
  close(retryMs: number): void;
}

/** How long to wait before try number `attempt` (from 0), `random` in [0, 1). */
export function backoff(attempt: number, random: number): number {
  const longest = Math.min(LONGEST_MS, FIRST_MS * 2 ** Math.min(attempt, 10));
  return longest * (0.5 + random / 2);
}

export class Socket {
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private attempt = 0;

  constructor(private readonly url: string, private readonly subprotocol: string, private readonly events: SocketEvents) {}

  start(): void {
    if (this.socket) return;
    const socket = new WebSocket(this.url, this.subprotocol);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    let opened = Infinity;
    socket.onopen = () => ((opened = performance.now()), this.events.open());
    socket.onmessage = ({ data }) => {
      if (data instanceof ArrayBuffer && this.socket === socket) this.events.message(new Uint8Array(data));
    };
    socket.onclose = () => {
      if (this.socket === socket) this.lost(performance.now() - opened > STABLE_MS);
    };
  }

  /** Bytes of one message; dropped if there is no connection. */
  send(data: Uint8Array<ArrayBuffer>): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(data);
  }

  /** Close this connection and try another. */
  drop(): void {
    if (!this.socket) return;
    this.discard();
    this.lost(false);
  }

  stop(): void {
    clearTimeout(this.timer);
    this.discard();
  }

  private lost(wasStable: boolean): void {
    this.socket = null;
    if (wasStable) this.attempt = 0;
    const wait = backoff(this.attempt++, Math.random());
    this.timer = setTimeout(() => this.start(), wait);
    this.events.close(wait);
  }

  private discard(): void {
    const socket = this.socket;
    this.socket = null;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close(1000);
  }
}
