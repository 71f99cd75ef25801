// The rooms in three dimensions, turned with the mouse or the arrow keys.
import {
  AmbientLight, Box3, Color, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { element } from "./element.js";

export function modelView(data) {
  const words = "Model of the rooms: drag or use the arrow keys to turn it, + and − to come nearer";
  const canvas = element("canvas", { class: "model", tabindex: "0", role: "img", "aria-label": words });
  const hint = element("p", { class: "quiet" }, "Drag, or use the arrow keys, to turn; + and − zoom.");
  // Where there is no graphics, the rest of the report stands all the same.
  try {
    show(canvas, data.model);
  } catch {
    return element("p", {}, "This browser shows no 3-D graphics.");
  }
  return element("div", {}, [canvas, hint]);
}

function show(canvas, base64) {
  const renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  const scene = new Scene();
  scene.background = new Color("#f4f5f6");
  const camera = new PerspectiveCamera(45, 16 / 9, 0.05, 500);
  const light = new DirectionalLight("#ffffff", 1.6);
  light.position.set(5, 20, 10);
  scene.add(new AmbientLight("#ffffff", 1.8), light);
  const controls = new OrbitControls(camera, canvas);
  const draw = () => {
    const width = canvas.clientWidth || 800;
    const height = canvas.clientHeight || 450;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
  };
  controls.addEventListener("change", draw);
  new ResizeObserver(draw).observe(canvas);
  canvas.addEventListener("keydown", (event) => turn(event, camera, controls));
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  new GLTFLoader().parse(bytes.buffer, "", (model) => {
    scene.add(model.scene);
    const box = new Box3().setFromObject(model.scene);
    const middle = box.getCenter(new Vector3());
    const size = box.getSize(new Vector3());
    const reach = Math.max(size.x, size.z);
    camera.position.set(middle.x + 0.2 * reach, middle.y + 0.85 * reach, middle.z + 0.7 * reach);
    controls.target.copy(middle);
    controls.update();
    draw();
    canvas.dataset.shown = "yes";
  });
}

function turn(event, camera, controls) {
  const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
  const zooms = { "+": 0.9, "-": 1.1, "−": 1.1 };
  const offset = camera.position.clone().sub(controls.target);
  if (event.key in moves) {
    const [round, down] = moves[event.key];
    offset.applyAxisAngle(new Vector3(0, 1, 0), round);
    const side = new Vector3(0, 1, 0).cross(offset).normalize();
    const tilted = offset.clone().applyAxisAngle(side, down);
    if (Math.hypot(tilted.x, tilted.z) > 0.05 * tilted.length()) offset.copy(tilted);
  } else if (event.key in zooms) {
    offset.multiplyScalar(zooms[event.key]);
  } else {
    return;
  }
  event.preventDefault();
  camera.position.copy(controls.target).add(offset);
  controls.update();
}
