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
  "longest_look_ahead": 1000
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

/** First message of a session; nothing else is taken before it. */
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
  /** reserved for authorisation */
  token?: string;
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

/** The turn's text is complete. */
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
  /** samples of the turn heard until now; the last ack counts if absent */
  heard?: number;
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

/** Answer to `hello`: what this server can do. */
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
}

/** A turn's format. Comes before its first packet. */
export interface Begin {
  type: "begin";
  /** the turn */
  turn: number;
  /** voice that speaks it */
  voice: string;
  /** its language */
  lang: string;
  /** Hz; the unit of every sample number of the turn */
  sample_rate: number;
  /** FAP frames a second */
  fps: 25 | 50;
}

/** 40 ms of a turn: sound, the FAP frames of exactly those samples, and the marks that begin in them. The last packet of a turn may be shorter. */
export interface Packet {
  type: "packet";
  /** the turn */
  turn: number;
  /** number of the first sample; packets of a turn follow each other without a gap */
  sample: number;
  /** mono little-endian int16 samples */
  pcm: Int16Array;
  /** frames x len(ready.faps) little-endian int32 values in FAP units; frame k of a turn holds at sample k * sample_rate / fps */
  faps: Int32Array;
  /** in order of sample */
  marks?: Mark[];
  /** the text has run dry: what follows may come late without being a fault */
  hold?: boolean;
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
}

export type ClientMessage = Hello | Speak | End | Interrupt | Ack | Ping | Bye;
export type ServerMessage = Bye | Ready | Begin | Packet | Done | Pong | Error;
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
    "max": 8192
   },
   {
    "name": "faps",
    "type": "i32",
    "max": 1024
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
   }
  ]
 }
};

export const SESSION_CLIENT: Record<string, Record<string, string>> = {
 "opening": {
  "hello": "open",
  "bye": "closed"
 },
 "open": {
  "speak": "open",
  "end": "open",
  "interrupt": "open",
  "ack": "open",
  "ping": "open",
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
  "done": "open",
  "pong": "open",
  "error": "open",
  "bye": "closed"
 },
 "closed": {
  "error": "closed"
 }
};

export const TURN_CLIENT: Record<string, Record<string, string>> = {
 "new": {
  "speak": "feeding"
 },
 "feeding": {
  "speak": "feeding",
  "end": "ended",
  "interrupt": "stopping",
  "ack": "feeding"
 },
 "ended": {
  "interrupt": "stopping",
  "ack": "ended"
 },
 "stopping": {
  "speak": "stopping",
  "end": "stopping",
  "interrupt": "stopping",
  "ack": "stopping"
 },
 "over": {
  "speak": "over",
  "end": "over",
  "interrupt": "over",
  "ack": "over"
 }
};

export const TURN_SERVER: Record<string, Record<string, string>> = {
 "feeding": {
  "begin": "feeding",
  "packet": "feeding",
  "done": "over",
  "error": "feeding"
 },
 "ended": {
  "begin": "ended",
  "packet": "ended",
  "done": "over",
  "error": "ended"
 },
 "stopping": {
  "begin": "stopping",
  "packet": "stopping",
  "done": "over",
  "error": "stopping"
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
 "unknown_voice": false,
 "unknown_language": false,
 "voice_unavailable": false,
 "synthesis_failed": false,
 "timeout": true,
 "internal": true
};
