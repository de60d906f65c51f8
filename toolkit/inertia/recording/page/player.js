"use strict";

const state = document.getElementById("state");

/** Return the bytes of a part: those in the page, which are compressed, or what the server has under its name. */
async function bytes(name) {
  const blocks = document.querySelectorAll(`script[data-part=${name}]`);
  if (blocks.length === 0) {
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(`${name}: ${answer.status} ${answer.statusText}`);
    return new Uint8Array(await answer.arrayBuffer());
  }
  const pieces = Array.from(blocks, (block) => {
    const text = atob(block.textContent);
    block.remove();
    return Uint8Array.from(text, (character) => character.charCodeAt(0));
  });
  const unpacked = new Blob(pieces).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(unpacked).arrayBuffer());
}

function stopped(reason) {
  document.body.append(state);
  state.textContent =
    `This browser does not play it: ${reason}. It takes one of 2023 or later with WebGL 2: ` +
    "Chrome, Edge or Chromium, Firefox 113, Safari 16.4.";
}

async function play() {
  await wasm_bindgen({ module_or_path: await bytes("viewer") });
  const viewer = new wasm_bindgen.WebHandle({
    url: [],
    hide_welcome_screen: true,
    enable_history: false,
    notebook: false,
    persist: false,
    theme: "dark",
    panel_state_overrides: { top: "Hidden" },
  });
  await viewer.start(document.getElementById("screen"));
  viewer.open_channel("recording", document.title);
  viewer.send_rrd_to_channel("recording", await bytes("recording"));
  viewer.close_channel("recording");
  state.remove();
  const watch = setInterval(() => {
    if (!viewer.has_panicked()) return;
    clearInterval(watch);
    stopped(viewer.panic_message());
  }, 1000);
}

play().catch(stopped);
