// Panoramas at their places: chosen on the plan or in a list, looked around in.
import { Viewer } from "@photo-sphere-viewer/core";
import { element } from "./element.js";

export function panoramaView(data) {
  const names = Object.keys(data.panoramas);
  if (!names.length) return { element: null, show: () => {} };
  const place = element("div", { class: "viewer" }, [
    element("p", { class: "hint" }, "Choose a camera on the plan, or here below."),
  ]);
  const choice = element(
    "select",
    { id: "camera-choice" },
    names.map((name) => element("option", { value: name }, name)),
  );
  const open = element("button", { type: "button" }, "Look around");
  const label = element("label", { for: "camera-choice" }, "Camera");
  const bar = element("p", { class: "bar" }, [label, choice, open]);
  let viewer = null;

  function show(name) {
    choice.value = name;
    for (const node of document.querySelectorAll(".camera")) {
      node.classList.toggle("chosen", node.dataset.camera === name);
    }
    const url = URL.createObjectURL(blob(data.panoramas[name]));
    if (viewer === null) {
      place.replaceChildren();
      viewer = new Viewer({
        container: place,
        panorama: url,
        caption: name,
        navbar: ["zoom", "move", "caption", "fullscreen"],
        keyboard: "always",
        loadingTxt: "",
      });
      viewer.addEventListener("panorama-loaded", () => (place.dataset.shown = choice.value));
      place.viewer = viewer;
    } else {
      viewer.setPanorama(url, { caption: name, transition: false });
    }
    place.scrollIntoView({ block: "nearest" });
  }
  open.addEventListener("click", () => show(choice.value));
  return { element: element("div", {}, [place, bar]), show };
}

function blob(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Blob([bytes], { type: "image/jpeg" });
}
