// The alarm bar of every page, with the first two alarms and the sound.

function showAlarmBar(alarms) {
  const shown = alarms.filter((it) => !it.shelved);
  const lines = shown.slice(0, 2).map((alarm, place) => {
    const line = make("p");
    line.append(make("b", "▲ " + alarm.code));
    line.append(make("span", language === "zh" ? alarm.text_zh : alarm.text_en));
    if (place === 0 && shown.length > 1) line.append(make("b", bracketed(word("first_out"))));
    return line;
  });
  if (shown.length > 2) lines.push(make("p", "+ " + (shown.length - 2) + " " + word("more_alarms")));
  at("alarms").className = shown.length ? "bad" : "";
  at("alarms").replaceChildren(...(lines.length ? lines : [make("p", word("no_alarm"))]));
}

// --- sound ---

let muted = stored.get("muted") === "yes";
let speaker = null;
let soundedAt = 0;
const SOUND_EVERY_MS = 2000;

// Sounds two tones while an alarm is neither acknowledged nor shelved.
function sound(alarms) {
  const wanted = alarms.some((it) => it.state === "unacknowledged" && !it.shelved);
  at("mute").textContent = word(muted ? "sound-off" : "sound-on");
  at("mute").setAttribute("aria-pressed", muted);
  at("mute").dataset.sounding = wanted && !muted;
  const now = performance.now();
  if (!wanted || muted || now - soundedAt < SOUND_EVERY_MS) return;
  soundedAt = now;
  speaker = speaker || new AudioContext();
  speaker.resume().then(() => [[880, 0], [660, .25]].forEach(([hertz, after]) => {
    const tone = speaker.createOscillator(), volume = speaker.createGain();
    tone.frequency.value = hertz;
    volume.gain.value = .15;
    tone.connect(volume).connect(speaker.destination);
    tone.start(speaker.currentTime + after);
    tone.stop(speaker.currentTime + after + .2);
  }), () => { /* without a loudspeaker only the colour warns */ });
}

at("mute").addEventListener("click", () => {
  muted = !muted;
  stored.set("muted", muted ? "yes" : "no");
  showView();
});
