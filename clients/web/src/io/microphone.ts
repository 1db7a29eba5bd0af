/** Sound that comes in: a microphone, or any other stream of the page, as samples. */

import { HeadFault } from "../client/turn";

/** What a microphone is asked for: the head speaks aloud beside it. */
const WISHES: MediaTrackConstraints = { echoCancellation: true, noiseSuppression: true, autoGainControl: true, channelCount: 1 };
/** No turn has another rate. */
const RATES = { least: 8000, most: 48_000 };

export interface Capture {
  /** Samples a second. */
  readonly rate: number;
  stop(): void;
}

/** The microphone, if the user allows it. Rejects with a HeadFault. */
export async function microphone(): Promise<MediaStream> {
  if (!navigator.mediaDevices) throw new HeadFault("microphone_unavailable", "this page is not allowed to use a microphone; open it over https, or from localhost");
  try {
    return await navigator.mediaDevices.getUserMedia({ audio: WISHES });
  } catch (e) {
    throw new HeadFault("microphone_unavailable", `the microphone cannot be used: ${(e as Error).message}`);
  }
}

/** Hand every sample of a stream to `take`, mono; `ended` when there will be no more. `module`: the sound processor's script. */
export async function capture(
  stream: MediaStream, module: string, take: (pcm: Int16Array) => void, ended: () => void,
): Promise<Capture> {
  const [track] = stream.getAudioTracks();
  if (!track) throw new HeadFault("microphone_unavailable", "the stream has no sound");
  const rate = Math.min(RATES.most, Math.max(RATES.least, track.getSettings().sampleRate ?? RATES.most));
  const context = new AudioContext({ sampleRate: rate });
  await context.audioWorklet.addModule(module);
  const source = context.createMediaStreamSource(stream);
  const node = new AudioWorkletNode(context, "fap-capture", { numberOfOutputs: 0, channelCount: 1, channelCountMode: "explicit" });
  const stop = () => {
    node.port.onmessage = null;
    source.disconnect();
    void context.close();
  };
  node.port.onmessage = ({ data }: MessageEvent<Int16Array>) => take(data);
  track.addEventListener("ended", ended, { once: true });
  source.connect(node);
  await context.resume();
  return { rate, stop };
}
