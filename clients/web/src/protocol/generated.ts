// Generated from protocol/schema by tools/generate_protocol.py. Do not edit.

export const SUBPROTOCOL = "fapstream.v1";
export const LIMITS = {
  "max_message_bytes": 1048576,
  "max_fragment_bytes": 65536,
  "max_pending_text": 262144,
  "max_pending_turns": 16,
  "hello_deadline_ms": 5000,
  "interrupt_deadline_ms": 2000,
  "packet_ms": 40,
  "max_faps": 68,
  "longest_look_ahead": 1000,
  "key_packets": 25,
  "ring_ms": 10000,
  "linger_ms": 30000
} as const;

export interface FieldSpec {
  name: string;
  type: "int" | "str" | "bool" | "text" | "u8" | "i16" | "i32" | "list";
  optional?: boolean;
  min?: number;
  max?: number;
  enum?: (string | number)[];
  of?: string;
}

/** Part of a message: voice. */
export interface Voice {
  /** what `speak.voice` takes */
  name: string;
  /** language it speaks, `en` or `el` */
  lang: string;
  /** `mbrola` or `espeak` */
  engine: string;
  /** Hz */
  sample_rate: number;
  /** for people */
  description?: string;
}

/** Part of a message: mark. */
export interface Mark {
  /** what begins, or is met in the text */
  kind: "phone" | "word" | "caption" | "expression" | "mark" | "warning";
  /** sample of the turn at which it begins to be heard */
  sample: number;
  /** samples */
  duration: number;
  /** phone name, word as written, caption, expression name, name of an SSML mark, or what is wrong with the mark-up */
  text: string;
  /** first code point in the turn's text */
  char_start?: number;
  /** one past the last code point */
  char_end?: number;
}

/** First message of a session that speaks; nothing else is taken before it. */
export interface Hello {
  type: "hello";
  /** program and version, for logs */
  client?: string;
  /** FAP frames a second; 25 if absent */
  fps?: 25 | 50;
  /** default language of turns */
  lang?: string;
  /** default voice of turns */
  voice?: string;
  /** what allows it, where the server asks for that */
  token?: string;
  /** let others listen to this session; `ready` says how */
  share?: boolean;
  /** speak into this channel of the server, for all who listen to it */
  channel?: string;
  /** go on with the session whose `ready.resume` this is */
  resume?: string;
  /** with `resume`: counted messages of that session received */
  received?: number;
}

/** First message of a session that only watches and listens to what is spoken into a channel. */
export interface Listen {
  type: "listen";
  /** a channel of the server, or `ready.channel` of a session that is shared */
  channel: string;
  /** program and version, for logs */
  client?: string;
  /** what allows it: of scope `listen`, or `ready.listen` of a shared session */
  token?: string;
  /** what is still sent when the connection is too slow for both; sound if absent */
  prefer?: "sound" | "face";
  /** after a lost connection: the `live.talk` that was being heard */
  talk?: string;
  /** with `talk`: the turn being received */
  turn?: number;
  /** with `turn`: samples of it received */
  sample?: number;
}

/** A fragment of a turn's text; the first one opens the turn. */
export interface Speak {
  type: "speak";
  /** chosen by the client, ascending */
  turn: number;
  /** UTF-8 bytes (`bin`), or a whole `str` */
  text: Uint8Array;
  /** language of this turn; read from the first fragment only */
  lang?: string;
  /** voice of this turn; read from the first fragment only */
  voice?: string;
  /** speaking rate in percent; read from the first fragment only */
  rate?: number;
  /** pitch in percent of the voice's own; read from the first fragment only */
  pitch?: number;
  /** loudness in percent; read from the first fragment only */
  volume?: number;
  /** words after a word that are waited for before it is spoken; the server's default if absent, 1000 for the whole phrase; read from the first fragment only */
  look_ahead?: number;
}

/** A fragment of a turn's sound: somebody speaks himself, and the face follows; the first one opens the turn. */
export interface Hear {
  type: "hear";
  /** chosen by the client, ascending */
  turn: number;
  /** mono little-endian int16 samples, as they are recorded or faster */
  pcm: Int16Array;
  /** Hz; in the first fragment, and read from there only */
  sample_rate?: number;
}

/** The turn's text or sound is complete. */
export interface End {
  type: "end";
  /** the turn */
  turn: number;
}

/** Stop the turn and drop what has not been heard. Turns queued behind it go on. */
export interface Interrupt {
  type: "interrupt";
  /** the turn */
  turn: number;
  /** samples of the turn heard until now; the server's own reckoning counts if absent */
  heard?: number;
}

/** The turn's text is revised: what follows `char` is dropped, and `speak` goes on from there. */
export interface Splice {
  type: "splice";
  /** the turn */
  turn: number;
  /** code points of the turn's text that stay */
  char: number;
  /** samples of the turn heard until now; the server's own reckoning counts if absent */
  heard?: number;
}

/** Say it again from the beginning of a sentence. */
export interface Seek {
  type: "seek";
  /** the turn */
  turn: number;
  /** 0: the sentence being heard; 1: the one before it; and so on */
  back: number;
  /** samples of the turn heard until now; the server's own reckoning counts if absent */
  heard?: number;
}

/** The turn stops where it is, until `continue`. From a server: the speaker has done so. */
export interface Pause {
  type: "pause";
  /** the turn */
  turn: number;
  /** sample at which it stops; from a client: samples heard until now */
  heard?: number;
}

/** The turn goes on after `pause`. */
export interface Continue {
  type: "continue";
  /** the turn */
  turn: number;
}

/** What the listener has, sent a few times a second while a turn plays. */
export interface Ack {
  type: "ack";
  /** the turn being heard */
  turn: number;
  /** sample of the turn being heard now */
  sample: number;
  /** samples received and not yet heard */
  queue: number;
  /** times the sound ran dry since the session began */
  underruns: number;
  /** picture minus sound in microseconds; positive: the face is late */
  skew: number;
  /** counted messages received; what the server keeps for a resumption ends there */
  received?: number;
  /** packets that came after their sound was due, since the session began */
  late?: number;
}

/** Answered at once by `pong`; browsers cannot see websocket pings. */
export interface Ping {
  type: "ping";
  /** returned as it is */
  id: number;
}

/** The sender closes the session in peace. */
export interface Bye {
  type: "bye";
  /** for people */
  reason?: string;
}

/** Answer to `hello` and `listen`: what this server can do. */
export interface Ready {
  type: "ready";
  /** program and version */
  server: string;
  /** identifies the session in logs */
  session: string;
  /** FAP frames a second of every turn */
  fps: 25 | 50;
  /** the FAP numbers of one frame, in order; low-level FAPs only */
  faps: Uint8Array;
  /** voices that can be asked for */
  voices: Voice[];
  /** names of head files under `/heads/` */
  heads: string[];
  /** for `hello.resume` after a lost connection; to be kept secret */
  resume?: string;
  /** the session asked for goes on; if absent it is a new one */
  resumed?: boolean;
  /** with `resumed`: counted messages that the server had received of the session */
  received?: number;
  /** what others `listen` to, if the session is shared */
  channel?: string;
  /** token to listen with, if the server asks for tokens */
  listen?: string;
}

/** To a listener: whether somebody speaks into the channel, and who. */
export interface Live {
  type: "live";
  /** the channel */
  channel: string;
  /** somebody is there to speak */
  on: boolean;
  /** names the speaker's session; with a new one the turns known so far are over */
  talk?: string;
}

/** To a listener: something was left out; the next packet may lie later than the last one ended, or belong to another turn. */
export interface Skip {
  type: "skip";
  /** `slow`: the connection took too little; `bus`: lost between the server's parts */
  reason: "slow" | "bus";
}

/** A turn's format. Comes before its first packet. */
export interface Begin {
  type: "begin";
  /** the turn */
  turn: number;
  /** voice that speaks it; empty in a turn of `hear` */
  voice: string;
  /** its language */
  lang: string;
  /** Hz; the unit of every sample number of the turn */
  sample_rate: number;
  /** FAP frames a second */
  fps: 25 | 50;
  /** of a turn of `hear`: how many samples later than it came sound can be sent back, as the face needs them */
  delay?: number;
  /** to a listener who comes late: where its packets begin; 0 if absent */
  sample?: number;
  /** to a listener who comes late: the word and the caption in force there */
  marks?: Mark[];
}

/** 40 ms of a turn: sound, the FAP frames of exactly those samples, and the marks that begin in them. The last packet of a turn may be shorter. */
export interface Packet {
  type: "packet";
  /** the turn */
  turn: number;
  /** number of the first sample; packets of a turn follow each other without a gap */
  sample: number;
  /** mono little-endian int16 samples; absent if the sound was left out */
  pcm?: Int16Array;
  /** how many, if the sound was left out */
  samples?: number;
  /** the first frame starts from the neutral face instead of the frame before it */
  key?: boolean;
  /** frames x ceil(n / 8) bytes, n = len(ready.faps): bit b of byte a set if channel 8 a + b changes in that frame; absent if there are no frames, or they were left out */
  mask?: Uint8Array;
  /** new values of the changed channels in FAP units, frame by frame */
  faps?: Int16Array;
  /** instead of `faps` if a value needs more than 16 bits */
  wide?: Int32Array;
  /** in order of sample */
  marks?: Mark[];
  /** the text has run dry: what follows may come late without being a fault */
  hold?: boolean;
}

/** The turn was revised (`splice`, `seek`): what it has from `sample` on is void, and a packet begins there. */
export interface Discard {
  type: "discard";
  /** the turn */
  turn: number;
  /** the first void sample */
  sample: number;
  /** code point of the turn's text at which it goes on; after a `splice` more than was asked for if more had been heard */
  char: number;
}

/** The turn is over; no packet of it follows. */
export interface Done {
  type: "done";
  /** the turn */
  turn: number;
  /** why */
  reason: "end" | "interrupted" | "failed";
  /** samples of the turn sent in all */
  samples: number;
  /** after an interrupt: samples heard, never more than were sent */
  heard?: number;
  /** after an interrupt: code points of the turn's text heard, to the end of the last word begun */
  char?: number;
}

/** Answer to `ping`. */
export interface Pong {
  type: "pong";
  /** as in the ping */
  id: number;
  /** counted messages received from the client; it need not keep them for a resumption */
  received?: number;
}

/** Something could not be done. What was accepted before stands. */
export interface Error {
  type: "error";
  /** one of schema/errors.json; more may come */
  code: string;
  /** what was wrong, where, and what to do */
  message: string;
  /** the server closes the session after this */
  fatal: boolean;
  /** the turn concerned */
  turn?: number;
  /** when it may be tried again */
  retry_ms?: number;
}

export type ClientMessage = Hello | Listen | Speak | Hear | End | Interrupt | Splice | Seek | Pause | Continue | Ack | Ping | Bye;
export type ServerMessage = Pause | Continue | Bye | Ready | Live | Skip | Begin | Packet | Discard | Done | Pong | Error;
export type Message = ClientMessage | ServerMessage;

export const STRUCTS: Record<string, FieldSpec[]> = {
 "voice": [
  {
   "name": "name",
   "type": "str",
   "max": 64
  },
  {
   "name": "lang",
   "type": "str",
   "max": 16
  },
  {
   "name": "engine",
   "type": "str",
   "max": 16
  },
  {
   "name": "sample_rate",
   "type": "int",
   "min": 8000,
   "max": 48000
  },
  {
   "name": "description",
   "type": "str",
   "max": 200,
   "optional": true
  }
 ],
 "mark": [
  {
   "name": "kind",
   "type": "str",
   "enum": [
    "phone",
    "word",
    "caption",
    "expression",
    "mark",
    "warning"
   ]
  },
  {
   "name": "sample",
   "type": "int",
   "min": 0
  },
  {
   "name": "duration",
   "type": "int",
   "min": 0
  },
  {
   "name": "text",
   "type": "str",
   "max": 4096
  },
  {
   "name": "char_start",
   "type": "int",
   "min": 0,
   "optional": true
  },
  {
   "name": "char_end",
   "type": "int",
   "min": 0,
   "optional": true
  }
 ]
};

export const MESSAGES: Record<string, { from: string; fields: FieldSpec[] }> = {
 "hello": {
  "from": "client",
  "fields": [
   {
    "name": "client",
    "type": "str",
    "max": 200,
    "optional": true
   },
   {
    "name": "fps",
    "type": "int",
    "enum": [
     25,
     50
    ],
    "optional": true
   },
   {
    "name": "lang",
    "type": "str",
    "max": 16,
    "optional": true
   },
   {
    "name": "voice",
    "type": "str",
    "max": 64,
    "optional": true
   },
   {
    "name": "token",
    "type": "str",
    "max": 4096,
    "optional": true
   },
   {
    "name": "share",
    "type": "bool",
    "optional": true
   },
   {
    "name": "channel",
    "type": "str",
    "max": 64,
    "optional": true
   },
   {
    "name": "resume",
    "type": "str",
    "max": 128,
    "optional": true
   },
   {
    "name": "received",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "listen": {
  "from": "client",
  "fields": [
   {
    "name": "channel",
    "type": "str",
    "max": 64
   },
   {
    "name": "client",
    "type": "str",
    "max": 200,
    "optional": true
   },
   {
    "name": "token",
    "type": "str",
    "max": 4096,
    "optional": true
   },
   {
    "name": "prefer",
    "type": "str",
    "enum": [
     "sound",
     "face"
    ],
    "optional": true
   },
   {
    "name": "talk",
    "type": "str",
    "max": 64,
    "optional": true
   },
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647,
    "optional": true
   },
   {
    "name": "sample",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "speak": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "text",
    "type": "text",
    "max": 65536
   },
   {
    "name": "lang",
    "type": "str",
    "max": 16,
    "optional": true
   },
   {
    "name": "voice",
    "type": "str",
    "max": 64,
    "optional": true
   },
   {
    "name": "rate",
    "type": "int",
    "min": 25,
    "max": 400,
    "optional": true
   },
   {
    "name": "pitch",
    "type": "int",
    "min": 25,
    "max": 400,
    "optional": true
   },
   {
    "name": "volume",
    "type": "int",
    "min": 0,
    "max": 400,
    "optional": true
   },
   {
    "name": "look_ahead",
    "type": "int",
    "min": 0,
    "max": 1000,
    "optional": true
   }
  ]
 },
 "hear": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "pcm",
    "type": "i16",
    "max": 8192
   },
   {
    "name": "sample_rate",
    "type": "int",
    "min": 8000,
    "max": 48000,
    "optional": true
   }
  ]
 },
 "end": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   }
  ]
 },
 "interrupt": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "heard",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "splice": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "char",
    "type": "int",
    "min": 0
   },
   {
    "name": "heard",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "seek": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "back",
    "type": "int",
    "min": 0,
    "max": 100
   },
   {
    "name": "heard",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "pause": {
  "from": "both",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "heard",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "continue": {
  "from": "both",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   }
  ]
 },
 "ack": {
  "from": "client",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "sample",
    "type": "int",
    "min": 0
   },
   {
    "name": "queue",
    "type": "int",
    "min": 0
   },
   {
    "name": "underruns",
    "type": "int",
    "min": 0
   },
   {
    "name": "skew",
    "type": "int"
   },
   {
    "name": "received",
    "type": "int",
    "min": 0,
    "optional": true
   },
   {
    "name": "late",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "ping": {
  "from": "client",
  "fields": [
   {
    "name": "id",
    "type": "int",
    "min": 0,
    "max": 4294967295
   }
  ]
 },
 "bye": {
  "from": "both",
  "fields": [
   {
    "name": "reason",
    "type": "str",
    "max": 200,
    "optional": true
   }
  ]
 },
 "ready": {
  "from": "server",
  "fields": [
   {
    "name": "server",
    "type": "str",
    "max": 200
   },
   {
    "name": "session",
    "type": "str",
    "max": 64
   },
   {
    "name": "fps",
    "type": "int",
    "enum": [
     25,
     50
    ]
   },
   {
    "name": "faps",
    "type": "u8",
    "max": 68
   },
   {
    "name": "voices",
    "type": "list",
    "of": "voice",
    "max": 256
   },
   {
    "name": "heads",
    "type": "list",
    "of": "str",
    "max": 256
   },
   {
    "name": "resume",
    "type": "str",
    "max": 128,
    "optional": true
   },
   {
    "name": "resumed",
    "type": "bool",
    "optional": true
   },
   {
    "name": "received",
    "type": "int",
    "min": 0,
    "optional": true
   },
   {
    "name": "channel",
    "type": "str",
    "max": 64,
    "optional": true
   },
   {
    "name": "listen",
    "type": "str",
    "max": 4096,
    "optional": true
   }
  ]
 },
 "live": {
  "from": "server",
  "fields": [
   {
    "name": "channel",
    "type": "str",
    "max": 64
   },
   {
    "name": "on",
    "type": "bool"
   },
   {
    "name": "talk",
    "type": "str",
    "max": 64,
    "optional": true
   }
  ]
 },
 "skip": {
  "from": "server",
  "fields": [
   {
    "name": "reason",
    "type": "str",
    "enum": [
     "slow",
     "bus"
    ]
   }
  ]
 },
 "begin": {
  "from": "server",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "voice",
    "type": "str",
    "max": 64
   },
   {
    "name": "lang",
    "type": "str",
    "max": 16
   },
   {
    "name": "sample_rate",
    "type": "int",
    "min": 8000,
    "max": 48000
   },
   {
    "name": "fps",
    "type": "int",
    "enum": [
     25,
     50
    ]
   },
   {
    "name": "delay",
    "type": "int",
    "min": 0,
    "optional": true
   },
   {
    "name": "sample",
    "type": "int",
    "min": 0,
    "optional": true
   },
   {
    "name": "marks",
    "type": "list",
    "of": "mark",
    "max": 16,
    "optional": true
   }
  ]
 },
 "packet": {
  "from": "server",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "sample",
    "type": "int",
    "min": 0
   },
   {
    "name": "pcm",
    "type": "i16",
    "max": 8192,
    "optional": true
   },
   {
    "name": "samples",
    "type": "int",
    "min": 0,
    "max": 8192,
    "optional": true
   },
   {
    "name": "key",
    "type": "bool",
    "optional": true
   },
   {
    "name": "mask",
    "type": "u8",
    "max": 144,
    "optional": true
   },
   {
    "name": "faps",
    "type": "i16",
    "max": 1024,
    "optional": true
   },
   {
    "name": "wide",
    "type": "i32",
    "max": 1024,
    "optional": true
   },
   {
    "name": "marks",
    "type": "list",
    "of": "mark",
    "max": 512,
    "optional": true
   },
   {
    "name": "hold",
    "type": "bool",
    "optional": true
   }
  ]
 },
 "discard": {
  "from": "server",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "sample",
    "type": "int",
    "min": 0
   },
   {
    "name": "char",
    "type": "int",
    "min": 0
   }
  ]
 },
 "done": {
  "from": "server",
  "fields": [
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647
   },
   {
    "name": "reason",
    "type": "str",
    "enum": [
     "end",
     "interrupted",
     "failed"
    ]
   },
   {
    "name": "samples",
    "type": "int",
    "min": 0
   },
   {
    "name": "heard",
    "type": "int",
    "min": 0,
    "optional": true
   },
   {
    "name": "char",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "pong": {
  "from": "server",
  "fields": [
   {
    "name": "id",
    "type": "int",
    "min": 0,
    "max": 4294967295
   },
   {
    "name": "received",
    "type": "int",
    "min": 0,
    "optional": true
   }
  ]
 },
 "error": {
  "from": "server",
  "fields": [
   {
    "name": "code",
    "type": "str",
    "max": 64
   },
   {
    "name": "message",
    "type": "str",
    "max": 1000
   },
   {
    "name": "fatal",
    "type": "bool"
   },
   {
    "name": "turn",
    "type": "int",
    "min": 1,
    "max": 2147483647,
    "optional": true
   },
   {
    "name": "retry_ms",
    "type": "int",
    "min": 0,
    "max": 3600000,
    "optional": true
   }
  ]
 }
};

/** Messages that are not counted and not sent again after a lost connection. */
export const EPHEMERAL: ReadonlySet<string> = new Set(["hello", "listen", "ack", "ping", "ready", "pong"]);

export const SESSION_CLIENT: Record<string, Record<string, string>> = {
 "opening": {
  "hello": "open",
  "listen": "listening",
  "bye": "closed"
 },
 "open": {
  "speak": "open",
  "hear": "open",
  "end": "open",
  "interrupt": "open",
  "splice": "open",
  "seek": "open",
  "pause": "open",
  "continue": "open",
  "ack": "open",
  "ping": "open",
  "bye": "closed"
 },
 "listening": {
  "ack": "listening",
  "ping": "listening",
  "bye": "closed"
 },
 "closed": {}
};

export const SESSION_SERVER: Record<string, Record<string, string>> = {
 "opening": {
  "error": "opening",
  "bye": "closed"
 },
 "open": {
  "ready": "open",
  "begin": "open",
  "packet": "open",
  "discard": "open",
  "done": "open",
  "pong": "open",
  "error": "open",
  "bye": "closed"
 },
 "listening": {
  "ready": "listening",
  "live": "listening",
  "skip": "listening",
  "begin": "listening",
  "packet": "listening",
  "discard": "listening",
  "pause": "listening",
  "continue": "listening",
  "done": "listening",
  "pong": "listening",
  "error": "listening",
  "bye": "closed"
 },
 "closed": {
  "error": "closed"
 }
};

export const TURN_CLIENT: Record<string, Record<string, string>> = {
 "new": {
  "speak": "feeding",
  "hear": "hearing"
 },
 "feeding": {
  "speak": "feeding",
  "end": "ended",
  "interrupt": "stopping",
  "splice": "feeding",
  "seek": "feeding",
  "pause": "feeding",
  "continue": "feeding",
  "ack": "feeding"
 },
 "hearing": {
  "hear": "hearing",
  "end": "heard",
  "interrupt": "stopping",
  "pause": "hearing",
  "continue": "hearing",
  "ack": "hearing"
 },
 "heard": {
  "interrupt": "stopping",
  "pause": "heard",
  "continue": "heard",
  "ack": "heard"
 },
 "ended": {
  "interrupt": "stopping",
  "splice": "feeding",
  "seek": "ended",
  "pause": "ended",
  "continue": "ended",
  "ack": "ended"
 },
 "stopping": {
  "speak": "stopping",
  "hear": "stopping",
  "end": "stopping",
  "interrupt": "stopping",
  "splice": "stopping",
  "seek": "stopping",
  "pause": "stopping",
  "continue": "stopping",
  "ack": "stopping"
 },
 "watched": {
  "ack": "watched"
 },
 "over": {
  "speak": "over",
  "hear": "over",
  "end": "over",
  "interrupt": "over",
  "splice": "over",
  "seek": "over",
  "pause": "over",
  "continue": "over",
  "ack": "over"
 }
};

export const TURN_SERVER: Record<string, Record<string, string>> = {
 "new": {
  "begin": "watched"
 },
 "feeding": {
  "begin": "feeding",
  "packet": "feeding",
  "discard": "feeding",
  "done": "over",
  "error": "feeding"
 },
 "hearing": {
  "begin": "hearing",
  "packet": "hearing",
  "done": "over",
  "error": "hearing"
 },
 "heard": {
  "begin": "heard",
  "packet": "heard",
  "done": "over",
  "error": "heard"
 },
 "ended": {
  "begin": "ended",
  "packet": "ended",
  "discard": "ended",
  "done": "over",
  "error": "ended"
 },
 "stopping": {
  "begin": "stopping",
  "packet": "stopping",
  "discard": "stopping",
  "done": "over",
  "error": "stopping"
 },
 "watched": {
  "begin": "watched",
  "packet": "watched",
  "discard": "watched",
  "pause": "watched",
  "continue": "watched",
  "done": "over"
 },
 "over": {
  "error": "over"
 }
};

export const ERRORS: Record<string, boolean> = {
 "protocol": true,
 "bad_message": false,
 "unknown_turn": false,
 "too_many_turns": false,
 "text_too_long": false,
 "sound_too_long": false,
 "unknown_voice": false,
 "unknown_language": false,
 "voice_unavailable": false,
 "synthesis_failed": false,
 "busy": true,
 "unauthorised": true,
 "unknown_channel": true,
 "channel_taken": true,
 "too_slow": true,
 "timeout": true,
 "internal": true
};
