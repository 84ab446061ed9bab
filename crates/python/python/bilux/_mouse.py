"""How a page tells a view what the mouse does to its picture."""

# The moves are summed up, and sent once for each frame of the browser.
FOLLOW_MOUSE = """
const followMouse = (image, send) => {
  let moved = { drag: [0, 0], zoom: 1 }, waits = false;
  const sendAll = () => {
    waits = false;
    send(moved);
    moved = { drag: [0, 0], zoom: 1 };
  };
  const soon = () => {
    if (!waits) requestAnimationFrame(sendAll);
    waits = true;
  };
  image.addEventListener("pointerdown", (event) => image.setPointerCapture(event.pointerId));
  image.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    moved.drag[0] += event.movementX / image.width;
    moved.drag[1] += event.movementY / image.height;
    soon();
  });
  image.addEventListener("wheel", (event) => {
    event.preventDefault();
    moved.zoom *= Math.exp(-event.deltaY / 500);
    soon();
  }, { passive: false });
};
"""
