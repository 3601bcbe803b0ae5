// The prompt that waits at the rig, on every page: text, picture, and a button per choice.

let shownPrompt = "";

async function showPicture(prompt) {
  const picture = at("prompt_picture");
  picture.hidden = true;
  if (!prompt.picture) return;
  try {
    const address = await (await ask("/api/picture")).json();
    if (!address || shownPrompt !== prompt.name + language) return;
    picture.src = address;
    picture.hidden = false;
  } catch { /* the text says what to do */ }
}

function showPrompt() {
  const prompt = view.machine ? view.machine.prompt : null;
  at("prompt").hidden = !prompt;
  const shown = prompt ? prompt.name + language : "";
  if (shown === shownPrompt) return;
  shownPrompt = shown;
  at("prompt_answer").textContent = "";
  if (!prompt) return;
  const text = (it) => (language === "zh" ? it.text_zh : it.text_en);
  at("prompt_text").textContent = text(prompt);
  const answer = (it) => giveOrder({order: "answer", prompt: prompt.name, choice: it.name},
    (said) => { at("prompt_answer").textContent = said; });
  at("prompt_choices").replaceChildren(...prompt.choices.map((it) => button(text(it), () => answer(it), it.stops ? "stop" : "")));
  showPicture(prompt);
}
