"""A view as a widget, where anywidget is installed."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._mouse import FOLLOW_MOUSE

if TYPE_CHECKING:
    from ._view import View

SCRIPT = FOLLOW_MOUSE + """
export default {
  render({ model, el }) {
    const [image, caption] = [document.createElement("img"), document.createElement("div")];
    Object.assign(image, { width: model.get("width"), height: model.get("height"), draggable: false });
    image.style.cssText = "cursor: grab; touch-action: none; background: #8884";
    caption.style.cssText = "font: 12px sans-serif; opacity: 0.7";
    el.append(image, caption);
    let address = null;
    const show = () => {
      const bytes = model.get("png");
      if (bytes && bytes.byteLength) {
        if (address) URL.revokeObjectURL(address);
        address = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
        image.src = address;
      }
      caption.textContent = model.get("caption");
    };
    model.on("change:png", show);
    model.on("change:caption", show);
    show();
    followMouse(image, (moved) => model.send(moved));
  },
};
"""


def of(view: View) -> Any:
    """The view's widget; None without anywidget."""
    try:
        anywidget, traitlets = import_module("anywidget"), import_module("traitlets")
    except ImportError:
        return None
    members = {
        "_esm": SCRIPT,
        "png": traitlets.Bytes().tag(sync=True),
        "caption": traitlets.Unicode().tag(sync=True),
        "width": traitlets.Int().tag(sync=True),
        "height": traitlets.Int().tag(sync=True),
    }
    width, height = view.size
    widget = type("ViewWidget", (anywidget.AnyWidget,), members)(width=width, height=height)

    def show(png: bytes, caption: str) -> None:
        with widget.hold_sync():
            widget.caption = caption
            if png:
                widget.png = png

    view.show(show)
    widget.on_msg(lambda _widget, message, _buffers: view.receive(message) if isinstance(message, dict) else None)
    return widget
