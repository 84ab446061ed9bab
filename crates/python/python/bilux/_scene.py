"""Scenes: from files, generated, or from arrays."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _bilux
from ._amodal import Amodal, amodal_of
from ._bilux import Picture, Spec, Turntable
from ._progress import following
from ._types import Measured, Mesh, Object, Progress, Replay, Strategy, Transient

if TYPE_CHECKING:
    from ._view import View
    from .lidar import Beams, PointCloud

Path = str | os.PathLike[str]

LUMENS_PER_WATT = 683.0
"""The luminous flux in lumen of 1 W whose red, green and blue are equal."""

LABELS = (
    "depth", "z_depth", "normal", "camera_normal", "ids", "instance", "category", "position", "uv", "primitive", "barycentric",
    "motion", "backward_motion", "occluded",
)  # fmt: skip
"""The layers of `render(labels=True)`."""

MAX_MEMORY = 8 << 30
"""The number of bytes that reading a file, and approximately rendering it, may take by default."""


class Scene(_bilux.Scene):
    """A scene: objects, lights and cameras. A new one is empty.

    Without a camera, rendering frames everything; without lights, a studio lights it. Lengths are in metres. A scene
    may be changed between renders, and by other threads during a render, which does not see the change.

    Example:
        >>> scene = bilux.Scene()
        >>> red = bilux.materials.diffuse(reflectance=(0.8, 0.1, 0.1))
        >>> scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], material=red)
        0
        >>> scene.render(size=(32, 32), spp=1).pixels.shape
        (32, 32, 3)
    """

    _time: float = 0.0

    def add_mesh(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        material: Spec | None = None,
        transform: ArrayLike | None = None,
        name: str = "",
        category: str = "",
    ) -> int:
        """Adds an object.

        Args:
            vertices: (n, 3) positions.
            triangles: (m, 3) rows of vertices, counter-clockwise seen from outside.
            normals: (n, 3) shading normals; without them, the triangles are flat.
            uvs: (n, 2) texture coordinates, v upwards.
            colors: (n, 3) colours from 0 to 1, proportional to light; or uint8 as screens show them (sRGB), with or without
                alpha, which is left out. They multiply the colour of the material.
            material: one of `bilux.materials`; by default grey and diffuse, or white with `colors`.
            transform: a (4, 4) matrix from the mesh to the scene, whose last column is the translation.
            name: a name for messages and written files.
            category: what kind of thing it is, for labels, such as "chair".

        Returns:
            the object's number, for `set_transform` and the like.

        Raises:
            ValueError: if an array has the wrong shape, or holds what is not finite or out of range.
            TypeError: if an array holds no numbers.
        """
        _check_spec("material", material, optional=True)
        material, colors = _colored(material, colors)
        first, count = self._add(vertices, triangles, normals, uvs, colors, material, transform, name)
        if count != 1:
            for index in reversed(range(first, first + count)):
                self._remove(index)
            raise ValueError("transform: this is one object, with one (4, 4) matrix; add_instances takes several")
        if category:
            self.set_category(first, category)
        return first

    def add_instances(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        transforms: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        material: Spec | None = None,
        name: str = "",
        category: str = "",
    ) -> range:
        """Adds the same mesh several times, which takes hardly more memory than once.

        Args:
            vertices, triangles, normals, uvs, colors, material, name, category: as for `add_mesh`.
            transforms: (k, 4, 4) matrices, one for each instance.

        Returns:
            the numbers of the k objects.

        Example:
            >>> places = np.tile(np.eye(4), (5, 1, 1))
            >>> places[:, 0, 3] = range(5)
            >>> bilux.Scene().add_instances([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], places)
            range(0, 5)
        """
        _check_spec("material", material, optional=True)
        material, colors = _colored(material, colors)
        first, count = self._add(vertices, triangles, normals, uvs, colors, material, transforms, name)
        for number in range(first, first + count if category else first):
            self.set_category(number, category)
        return range(first, first + count)

    def merge(
        self, other: Scene, *, transform: ArrayLike | None = None, lights: bool = False, cameras: bool = False
    ) -> range:
        """Adds the objects of another scene, with their materials, textures and motion. Meshes are shared, not copied.

        Args:
            other: the scene, which stays as it is.
            transform: a (4, 4) matrix that moves all of its objects.
            lights: whether its lights are added too, where they are.
            cameras: whether its cameras are.

        Returns:
            the numbers of the new objects.

        Raises:
            ValueError: if the transform is no (4, 4) matrix with an inverse.

        Example:
            >>> room, ball = bilux.generate("cornell"), bilux.Scene()
            >>> number = ball.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], category="sail")
            >>> added = room.merge(ball)
            >>> len(added), room.objects[added[0]].category
            (1, 'sail')
        """
        return _range(*_bilux.merge(self, other, transform, lights, cameras))

    def pose(self, clip: str | int | None = None, time: float = 0.0) -> None:
        """Poses the objects of a file as one of its animations has them: skins, morphs and places.

        What this scene adds to the file comes after the file's own objects, and stays. To pose a model among others, pose it
        on its own, then `merge` it into their scene.

        Args:
            clip: the animation, by its name or number; by default the one that plays.
            time: seconds from its beginning.

        Raises:
            ValueError: if the scene is no file with an animation, or objects of the file were removed.
            SceneError: if there is no such animation.

        Example:
            >>> walker, places = bilux.Scene(), np.tile(np.eye(4), (2, 1, 1))
            >>> places[1, 0, 3] = 2
            >>> number = walker.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
            >>> walker.set_keyframes(number, [0, 1], places)
            >>> lost = walker.save("walker.glb")
            >>> crowd, walker = bilux.Scene(), bilux.load("walker.glb")
            >>> for time in (0.25, 0.75):
            ...     walker.pose(time=time)
            ...     added = crowd.merge(walker)
            >>> [float(thing.transform[0, 3]) for thing in crowd.objects]
            [0.5, 1.5]
        """
        _bilux.pose(self, None if clip is None else str(clip), float(time))
        self._time = float(time)

    def add_light(self, light: Spec) -> int:
        """Adds one of `bilux.lights`, and returns its number in `lights`."""
        _check_spec("light", light)
        return self._add_light(light)

    def add_camera(self, camera: Spec) -> int:
        """Adds one of `bilux.cameras`, and returns its number, which `render(camera=…)` takes."""
        _check_spec("camera", camera)
        return self._add_camera(camera)

    @property
    def objects(self) -> list[Object]:
        """What is known of each object, by its number; of those that move at time 0."""
        return self._objects_at(0.0)

    def _objects_at(self, time: float) -> list[Object]:
        return [Object(*self._object(index, time), *_bilux.labels_of(self, index)) for index in range(len(self))]

    @property
    def categories(self) -> list[str]:
        """The categories of its objects, sorted; the layer "category" counts them from 1."""
        found = (_bilux.labels_of(self, index)[0] for index in range(len(self)))
        return sorted({category for category in found if category}, key=str.encode)

    def mesh(self, object: int) -> Mesh:
        """Copies of the arrays of an object's mesh, in the mesh's own coordinates."""
        return Mesh(*_bilux.mesh_of(self, self._number(object)))

    def set_category(self, object: int, category: str) -> None:
        """Says what kind of thing an object is, for labels, such as "chair"; "" for nothing."""
        _bilux.set_category(self, self._number(object), category)

    def set_visibility(self, object: int, visibility: Literal["full", "no-camera", "hidden"]) -> None:
        """Says which rays see an object.

        Args:
            object: its number.
            visibility: "full" for all of them; "no-camera" for all but those of the camera, so that it is not in the picture
                but its shadow is, and mirrors show it; "hidden" for none, as if it were not there.

        Example:
            >>> scene = bilux.generate("cornell")
            >>> scene.set_visibility(5, "no-camera")
            >>> scene.objects[5].visibility
            'no-camera'
        """
        _bilux.set_visibility(self, self._number(object), visibility)

    def set_transform(self, object: int, transform: ArrayLike) -> None:
        """Places an object anew: a (4, 4) matrix from its mesh to the scene."""
        self._set_transform(self._number(object), transform)

    def set_keyframes(self, object: int, times: ArrayLike, transforms: ArrayLike) -> None:
        """Moves an object through transforms at given times, instead of placing it once.

        Between keyframes, translation and scale change evenly, and so does the rotation; before the first and after the
        last the object stands still. `render(time=…)` shows a moment, and `render(shutter=…)` blurs what moves while
        the shutter is open.

        Args:
            object: its number.
            times: (k,) increasing times in seconds.
            transforms: (k, 4, 4) matrices from its mesh to the scene: each a scale along the mesh's axes, then a
                rotation, then a translation.

        Raises:
            ValueError: if the arrays do not fit, or a matrix shears.

        Example:
            >>> scene = bilux.generate("cornell")
            >>> places = np.tile(np.eye(4), (2, 1, 1))
            >>> places[1, :3, 3] = (0, 0.2, 0)
            >>> scene.set_keyframes(0, [0, 1], places)
            >>> scene.render(size=32, spp=1, time=0.5, shutter=0.1).width
            32
        """
        _bilux.set_keyframes(self, self._number(object), np.asarray(times, np.float64), transforms)

    def set_material(self, object: int, material: Spec) -> None:
        """Makes an object of another material."""
        _check_spec("material", material)
        self._set_material(self._number(object), material)

    def remove(self, object: int) -> None:
        """Removes an object; those after it move up by one number."""
        self._remove(self._number(object))

    def _number(self, object: int) -> int:
        """The number of an object that there is."""
        number = operator.index(object)
        if not 0 <= number < len(self):
            raise IndexError(f"there is no object {number}: the scene has {len(self)}, counted from 0")
        return number

    def render(
        self,
        size: tuple[int, int] | int | str | None = None,
        integrator: str | None = None,
        spp: int | None = None,
        *,
        noise: float | None = None,
        time_limit: float | None = None,
        aov: Sequence[str] = (),
        labels: bool = False,
        next: Scene | None = None,
        previous: Scene | None = None,
        denoise: bool | str | None = None,
        seed: int | None = None,
        threads: int | None = None,
        camera: str | int | None = None,
        time: float | None = None,
        crop: tuple[int, int, int, int] | None = None,
        fast: bool = False,
        exposure: float | Literal["auto"] | None = None,
        tonemap: str | None = None,
        background: str | None = None,
        progress: bool | Callable[[Progress], object] = False,
        max_memory: int = MAX_MEMORY,
        **settings: Any,
    ) -> Picture:
        """Renders a picture, with the defaults of the command line.

        Runs without the GIL. Ctrl-C stops it and raises `Interrupted`, whose attribute `picture` is the picture so
        far.

        Args:
            size: width and height in pixels; one number for a square. By default what the scene says, else 512.
            integrator: the algorithm (`bilux.integrators`); by default what the scene says, else "auto".
            spp: samples per pixel: the picture is then the same on every machine, to the byte.
            noise: stop when the noise is, on average, at most this fraction of the light, such as 0.02.
            time_limit: finish within so many seconds, denoising included. Without `spp`, `noise` and `time_limit`, the
                picture is done at 2% noise or after 5 seconds.
            aov: layers to give as well (`bilux.aovs`), such as "albedo", "normal", "depth", "ids", "position",
                "crypto_object" or "direct": `picture["depth"]`. "groups" gives a layer for each light group, and
                "strategies" one for each strategy of "bdpt" and "vcm"; "labels" stands for all labels.
            labels: whether to give all labels: layers that are exact, from one ray through each pixel's centre, whatever the
                seed: "depth", "z_depth", "normal", "camera_normal", "ids", "instance", "category", "position", "uv",
                "primitive", "barycentric", "motion", "backward_motion" and "occluded".
            next, previous: the scene in the next frame and in the previous one, for the layers of motion, if more moves there
                than keyframes and the animation of the file say: a copy of this one, with other transforms, poses or cameras.
            denoise: True or a name (`bilux.denoisers`), or False; by default only if noise or time ends the picture.
                The noisy picture is then its layer "noisy".
            seed: of the random numbers.
            threads: 0, the default, for all cores.
            camera: by its name, or its number from 0.
            time: what moves is shown at this time, in seconds.
            crop: x, y, width, height of the window to render, in pixels.
            fast: the cleanest picture that about a second allows.
            exposure: stops (powers of two) by which formats for a display are brightened, or "auto".
            tonemap: the tone curve for formats for a display (`bilux.tonemaps`).
            background: "transparent", or a colour such as "white" or "#aabbcc".
            progress: True for a bar, or a function that gets a `Progress` about 20 times a second. If it returns
                False, the render stops, and the picture so far is returned; an exception stops it too, and comes out.
            max_memory: bytes that it may take, approximately.
            **settings: any other setting (`bilux.settings`), and the parameters of integrators.

        Returns:
            the picture, in linear light.

        Raises:
            SceneError: if something in the scene or a setting is wrong.
            RenderError: if it would take too much memory.

        Example:
            >>> picture = bilux.generate("cornell").render(size=64, spp=4)
            >>> picture.pixels.dtype, picture.info["spp"]
            (dtype('float32'), 4)
        """
        given = self._settings(
            size=size, integrator=integrator, spp=spp, noise=noise, time_limit=time_limit, seed=seed, threads=threads,
            denoise=denoise, camera=camera, time=time, exposure=exposure, tonemap=tonemap, background=background,
            **settings,
        )  # fmt: skip
        if fast and (spp, noise, time_limit) != (None, None, None):
            raise TypeError("fast: this sets its own limits: leave it out, or spp, noise and time_limit")
        layers = _layers(aov, labels)
        others = (next, previous)
        with following(progress) as callback:
            return self._render(given, layers, _window(crop), others, fast, _bytes(max_memory), self._time, callback)

    def amodal(
        self, objects: Sequence[int | Sequence[int]] | None = None, *, margin: int = 0, **settings: Any
    ) -> list[Amodal]:
        """Finds what the camera would see of each object if nothing hid it, and how much of that it does see.

        The rays are those of labels: one through each pixel's centre. Runs of pixels are kept, not pictures, so that memory
        grows with the outlines.

        Args:
            objects: the objects, by default all; a list of several in the place of a number makes one of them.
            margin: pixels on each side of the picture that are looked at as well, for objects that it cuts off.
            **settings: `size`, `camera`, `time` and others, as for `render`.

        Returns:
            one `Amodal` for each.

        Raises:
            IndexError: if there is no such object.
            ValueError: if an object is twice in a group.
            SceneError: if an object is in two groups, or the size makes no sense.

        Example:
            >>> [one] = bilux.generate("cornell").amodal([5], size=(64, 64))
            >>> one.mask.shape, 0 < one.visible_fraction <= 1
            ((64, 64), True)
        """
        numbers = range(len(self)) if objects is None else objects
        groups = [[self._number(one) for one in _several(group)] for group in numbers]
        twice = next((one for group in groups for one in group if group.count(one) > 1), None)
        if twice is not None:
            raise ValueError(f"objects: {twice} is there twice in a group")
        given, most = self._whole(settings)
        return amodal_of(groups, operator.index(margin), *_bilux.silhouettes(self, groups, operator.index(margin), given, most))

    def progressive(
        self,
        size: tuple[int, int] | int | str | None = None,
        integrator: str | None = None,
        spp: int = 1024,
        *,
        seed: int | None = None,
        threads: int | None = None,
        camera: str | int | None = None,
        time: float | None = None,
        exposure: float | Literal["auto"] | None = None,
        tonemap: str | None = None,
        background: str | None = None,
        progress: bool | Callable[[Progress], object] = False,
        max_memory: int = MAX_MEMORY,
        **settings: Any,
    ) -> Iterator[Picture]:
        """Renders ever better pictures: with 1, 2, 4, … samples per pixel, up to `spp`.

        Each picture contains the samples of those before it; the last one is that of `render(spp=spp)`, to the byte.
        Leave the loop when a picture is good enough.

        Args:
            spp: samples per pixel of the last picture.
            size, integrator, seed, threads, camera, time, exposure, tonemap, background, progress, max_memory,
                **settings: as for `render`.

        Raises:
            SceneError, RenderError, Interrupted: as for `render`.

        Example:
            >>> [picture.info["spp"] for picture in bilux.generate("cornell").progressive(size=16, spp=5)]
            [1, 2, 4, 5]
        """
        given = self._settings(
            size=size, integrator=integrator, spp=spp, seed=seed, threads=threads, camera=camera, time=time,
            exposure=exposure, tonemap=tonemap, background=background, **settings,
        )  # fmt: skip
        if given.keys() & {"noise", "time_limit"}:
            raise TypeError("progressive: noise and time_limit do not end it: leave the loop instead")
        given |= {"noise": 0, "time_limit": 0}
        self._checked_moment(given.get("time"))
        with following(progress) as callback:
            yield from self._progressive(given, _bytes(max_memory), callback)

    def turntable(
        self,
        count: int = 36,
        *,
        aov: Sequence[str] = (),
        fast: bool = False,
        progress: bool | Callable[[Progress], object] = False,
        max_memory: int = MAX_MEMORY,
        **settings: Any,
    ) -> Iterator[Picture]:
        """Renders pictures from all around a model, a full turn: those of `bilux render --turntable`.

        The studio's camera, which frames a model without a camera, moves around it; all pictures are framed and lit
        alike. What the scene builds is built once.

        Args:
            count: the number of pictures.
            aov, fast, progress, max_memory: as for `render`.
            **settings: any other keyword of `render`, apart from `crop`.

        Raises:
            SceneError, RenderError, Interrupted: as for `render`.
            ValueError: if `count` is less than 1.

        Example:
            >>> scene = bilux.Scene()
            >>> number = scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
            >>> [picture.width for picture in scene.turntable(3, size=16, spp=1)]
            [16, 16, 16]
        """
        number = operator.index(count)
        if not 0 < number < 1 << 32:
            raise ValueError(f"count: {number} is no number of pictures: give at least 1, such as 36")
        if "crop" in settings:
            raise TypeError("crop: a turntable shows all of each picture: leave it out")
        plain = dict.fromkeys(("size", "camera", "time", "exposure"))
        given = self._settings(**plain | settings)
        layers = _layers(aov)
        return self._turned(number, given, layers, fast, _bytes(max_memory), progress)

    def _turned(
        self,
        count: int,
        given: dict[str, Any],
        layers: Sequence[str],
        fast: bool,
        max_memory: int,
        progress: bool | Callable[[Progress], object],
    ) -> Iterator[Picture]:
        """The pictures of a turntable."""
        with following(progress) as callback:
            yield from Turntable(self, given, layers, fast, max_memory, self._time, callback, count)

    def view(
        self,
        size: tuple[int, int] | int = (480, 360),
        spp: int = 256,
        *,
        camera: int = 0,
        integrator: str = "path",
        **settings: Any,
    ) -> View:
        """Shows the scene in a notebook: a picture that gets better and better, which the mouse turns.

        Drag it to move the camera around; the wheel comes nearer. This needs the package anywidget; without it, only
        notebooks that let a page reach the kernel turn the picture, and others show it as it is.

        Args:
            size: width and height in pixels; one number for a square.
            spp: samples per pixel of the last picture.
            camera: the number of the scene's camera to begin with.
            integrator: the algorithm; the default shows something soonest.
            **settings: as for `progressive`.

        Returns:
            the view. It renders in a thread of its own, until its picture is done or `close` is called.

        Example:
            >>> view = bilux.generate("trio").view(size=(64, 48), spp=4)
            >>> view.move(turn=90)
            >>> view.wait().width
            64
        """
        from ._view import View

        return View(self, _sides(size), spp, operator.index(camera), settings | {"integrator": integrator})

    def lidar(
        self, beams: Beams | ArrayLike, *, pose: ArrayLike | None = None, time: float | None = None, **scanner: Any
    ) -> PointCloud:
        """What a laser scanner measures: all returns of each pulse, also behind glass and by mirrors, with noise.

        The scene is scanned as it is: no studio lights it or puts it on a ground. Each pulse meets moving objects where
        they are at its time. See the tutorial "Sensors" for what is simulated and what is left out.

        Args:
            beams: a pattern such as `bilux.lidar.spinning(...)`, or an array (n, 3) of directions.
            pose: a (4, 4) matrix from the scanner's axes (y up, looking along -z) to the scene; (n, 4, 4) for one each.
            time: when the scan begins, in seconds; by default the time of the scene's pose, else 0.
            **scanner: parameters of `bilux.lidar.parameters["lidar"]`, such as divergence=3 (mrad), rays=16,
                range_noise=0.02 (m), max_range=100, returns="first", channel="red" or seed=1.

        Returns:
            a `bilux.lidar.PointCloud`: points, ranges, intensities, objects and numbers of the returns.

        Raises:
            SceneError: if a parameter has a wrong name or a value out of range, or something in the scene is wrong.
            ValueError: if an array has a wrong shape, a direction has no length, or the pose is no rotation.

        Example:
            >>> pose = np.eye(4)
            >>> pose[:3, 3] = 0.28, 0.5, -0.8
            >>> cloud = bilux.generate("cornell").lidar([[0, 0, 1]], pose=pose)
            >>> cloud.range.round(2), cloud.number
            (array([1.36]), array([1]))
        """
        from .lidar import _scanned

        return _scanned(self, beams, pose, self._checked_moment(self._time if time is None else float(time)), scanner)

    def replay(self, x: int, y: int, sample: int = 0, **settings: Any) -> Replay:
        """Takes one sample of a picture again, and says what happens along its path.

        Args:
            x, y: the pixel, from the upper left corner.
            sample: the number of the sample, from 0.
            **settings: those of the picture, as for `render`, apart from `noise` and `time_limit`.

        Example:
            >>> replay = bilux.generate("cornell").replay(8, 8, size=16, integrator="path")
            >>> replay.rays > 0, len(replay.events) > 0
            (True, True)
        """
        given, most = self._whole(settings)
        return Replay(*_bilux.replay(self, (operator.index(x), operator.index(y), operator.index(sample)), given, most))

    def strategies(self, *, progress: bool | Callable[[Progress], object] = False, **settings: Any) -> list[Strategy]:
        """Renders a picture for each strategy of an integrator that has several, such as "bdpt" and "vcm".

        Args:
            progress: as for `render`. Without a picture if it stops the render.
            **settings: as for `render`, apart from `noise` and `time_limit`.

        Returns:
            the strategies, the shortest paths first. Their weighted pictures add up to that of `render`.

        Raises:
            SceneError: also if the integrator has no strategies.

        Example:
            >>> found = bilux.generate("cornell").strategies(size=16, spp=1, integrator="bdpt")
            >>> found[0].name, found[0].weighted.width
            ('s0-t2', 16)
        """
        given, most = self._whole(settings)
        with following(progress) as callback:
            found = _bilux.strategies(self, given, most, callback)
        return [Strategy(*one) for one in found or []]

    def transient(
        self,
        bin_width: float,
        bins: int,
        *,
        begin: float = 0.0,
        progress: bool | Callable[[Progress], object] = False,
        **settings: Any,
    ) -> Transient | None:
        """Renders a picture in intervals of the optical length of paths: what a time-of-flight sensor sees of a flash.

        Lengths are measured from where the camera's rays begin, times the index of refraction in glass. Light of 1 m is
        1 / 299,792,458 s old. For a flash at the camera, put a lamp there: a plate then returns its light at twice its distance.

        Args:
            bin_width: the length of each interval, in metres.
            bins: how many there are.
            begin: where the first one begins, in metres.
            progress: as for `render`.
            **settings: as for `render`, apart from `noise` and `time_limit`. The integrator is "path" or "bdpt", "path" by
                default.

        Returns:
            the light of each interval of each pixel, and the rest; None if `progress` stopped it.

        Raises:
            SceneError: if the integrator finds light without lengths, or the intervals take too much memory.

        Example:
            >>> found = bilux.generate("cornell").transient(0.05, 40, begin=1.0, size=16, spp=4)
            >>> found.light.shape, found.rest.shape, len(found.edges)
            ((16, 16, 40, 3), (16, 16, 3), 41)
        """
        count = operator.index(bins)
        if not 0 < count < 1 << 32:
            raise ValueError(f"bins: {count} is no number of intervals: give at least 1")
        given, most = self._whole({"integrator": "path"} | settings)
        with following(progress) as callback:
            found = _bilux.transient(self, given, most, (float(begin), float(bin_width), count), callback)
        return None if found is None else Transient(*found, begin + bin_width * np.arange(count + 1, dtype=np.float64))

    def irradiance(
        self,
        points: ArrayLike,
        normals: ArrayLike = (0.0, 1.0, 0.0),
        spp: int | None = None,
        *,
        noise: float | None = None,
        time_limit: float | None = None,
        progress: bool | Callable[[Progress], object] = False,
        **settings: Any,
    ) -> Measured:
        """Measures the light that points receive, on the sides of their normals.

        All light counts that path tracing finds: straight from lamps and sky, and after any number of reflections. A point that
        lies on a surface measures what that surface receives.

        Args:
            points: (n, 3) positions in metres.
            normals: (n, 3) directions, or one for all points; by default upwards.
            spp: samples of each point; by default 1,024, or what `noise` and `time_limit` allow.
            noise: stop when the noise is, on average, at most this fraction of the light, such as 0.02.
            time_limit: finish within so many seconds.
            progress: as for `render`.
            **settings: as for `render`, such as `seed`, `threads`, `time`, `max_depth` and `max_memory`.

        Returns:
            irradiances in W/m², an array (n, 3) for red, green and blue, and their standard errors.

        Raises:
            ValueError: if the arrays do not fit, or hold what is not finite.
            SceneError: if the scene has no light, or another integrator than "path" and "auto" is asked for.

        Example:
            >>> scene = bilux.Scene()
            >>> floor = scene.add_mesh([[-1, 0, 1], [1, 0, 1], [0, 0, -1]], [[0, 1, 2]])
            >>> sky = scene.add_light(bilux.lights.environment(radiance=1))
            >>> values, errors = scene.irradiance([[0, 0, 0]], spp=1024)
            >>> values.shape, bool(abs(values[0, 0] - np.pi) < 0.1)
            ((1, 3), True)
        """
        values, errors = self._measured(points, normals, spp, noise, time_limit, progress, settings)
        return Measured(values[:, :3], errors[:, :3])

    def illuminance(
        self,
        points: ArrayLike,
        normals: ArrayLike = (0.0, 1.0, 0.0),
        spp: int | None = None,
        *,
        noise: float | None = None,
        time_limit: float | None = None,
        progress: bool | Callable[[Progress], object] = False,
        **settings: Any,
    ) -> Measured:
        """Measures the illuminance of points, on the sides of their normals: as `irradiance`, in lux.

        Returns:
            illuminances in lx, an array (n,), and their standard errors. 683 lx are 1 W/m² of red, green and blue each.

        Example:
            >>> scene = bilux.Scene()
            >>> floor = scene.add_mesh([[-1, 0, 1], [1, 0, 1], [0, 0, -1]], [[0, 1, 2]])
            >>> lamp = scene.add_light(bilux.lights.point(position=(0, 2, 0), intensity="100 cd"))
            >>> values, errors = scene.illuminance([[0, 0, 0]], spp=16)
            >>> round(float(values[0]), 3)
            25.0
        """
        values, errors = self._measured(points, normals, spp, noise, time_limit, progress, settings)
        return Measured(values[:, 3] * LUMENS_PER_WATT, errors[:, 3] * LUMENS_PER_WATT)

    def _measured(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        spp: int | None,
        noise: float | None,
        time_limit: float | None,
        progress: bool | Callable[[Progress], object],
        settings: dict[str, Any],
    ) -> tuple[np.ndarray, np.ndarray]:
        """Irradiances and their errors, arrays (n, 4): red, green, blue and luminance."""
        if (spp, noise, time_limit) == (None, None, None):
            spp = 1024
        if spp is None:
            spp = 1 << 20
        given, max_memory = self._measuring(settings | {"spp": spp, "noise": noise or 0, "time_limit": time_limit or 0})
        points, normals = _sensors(points, normals)
        with following(progress) as callback:
            values, errors, _ = _bilux.irradiance(self, points, normals, given, max_memory, callback)
        return values, errors

    def _measuring(self, settings: dict[str, Any]) -> tuple[dict[str, Any], int]:
        """The settings of a measurement, and the bytes that it may take."""
        settings = {"integrator": "path"} | settings
        most = settings.pop("max_memory", MAX_MEMORY)
        fixed = {"size", "crop", "aov", "denoise", "filter", "exposure", "fast"} & settings.keys()
        if fixed:
            raise TypeError(f"{min(fixed)}: this is a setting of pictures, and nothing that points have")
        plain = dict.fromkeys(("size", "camera", "time", "exposure"))
        given = self._settings(**plain | settings) | {"texture_filter": "none"}
        self._checked_moment(given.get("time"))
        return given, _bytes(most)

    def _whole(self, settings: dict[str, Any]) -> tuple[dict[str, Any], int]:
        """The settings of a picture with all of its samples, and the bytes that it may take."""
        if settings.keys() & {"noise", "time_limit"}:
            raise TypeError("noise and time_limit have no effect here: give spp, the number of samples")
        most = settings.pop("max_memory", MAX_MEMORY)
        plain = dict.fromkeys(("size", "camera", "time", "exposure"))
        given = self._settings(**plain | settings) | {"noise": 0, "time_limit": 0}
        self._checked_moment(given.get("time"))
        return given, _bytes(most)

    def _checked_moment(self, time: float | None) -> float:
        """The moment that a call shows, in seconds; an error where the meshes of a file were read for another one."""
        return self._moment(self._asked_time(time), self._time)

    def _asked_time(self, time: float | None) -> float | None:
        """The time that a call asks for: if it says none, that of the pose."""
        return self._time or None if time is None else time

    def _settings(
        self,
        *,
        size: tuple[int, int] | int | str | None,
        camera: str | int | None,
        time: float | None,
        exposure: float | Literal["auto"] | None,
        denoise: bool | str | None = None,
        **settings: Any,
    ) -> dict[str, Any]:
        """The settings as the tables name them."""
        given = settings | {"size": _size(size), "denoise": _denoise(denoise)}
        given["camera"] = None if camera is None else str(camera)
        given["time"] = self._asked_time(time)
        given |= {"auto_exposure": True} if exposure == "auto" else {"exposure": exposure}
        return {key: value for key, value in given.items() if value is not None}

    def copy(self) -> Scene:
        """A copy that can be changed on its own. Meshes and textures are shared, not copied."""
        copy = type(self)()
        copy._time = self._time
        self._copy_to(copy)
        return copy

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: object) -> Scene:
        return self.copy()

    def __reduce__(self) -> Any:
        encoded = self._encoded()
        blobs = {hash: encoded.blob(hash) for hash in encoded.hashes}
        return _restored, (type(self), encoded.document, blobs, self._time)

    def _repr_png_(self) -> bytes | None:
        """A small picture, for notebooks."""
        if len(self) == 0:
            return None
        return self.render(size=(320, 240), fast=True)._repr_png_()


def _restored(kind: type[Scene], document: ArrayLike | bytes, blobs: dict[str, Any], time: float) -> Scene:
    """The scene of a pickle."""
    scene: Scene = kind._decoded(document, blobs)
    scene._time = time
    return scene


def _sensors(points: ArrayLike, normals: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Points and as many normals."""
    points, normals = np.asarray(points), np.asarray(normals)
    if points.shape == (3,):
        points = points[None]
    if normals.shape == (3,) and points.ndim == 2:
        normals = np.tile(normals, (len(points), 1))
    return points, normals


def _size(size: tuple[int, int] | int | str | None) -> str | None:
    """The size as settings have it."""
    if size is None or isinstance(size, str):
        return size
    width, height = _sides(size)
    return f"{width}x{height}"


def _sides(size: tuple[int, int] | int) -> tuple[int, int]:
    """The width and the height."""
    try:
        width, height = size if np.iterable(size) else (size, size)
        return operator.index(width), operator.index(height)
    except (TypeError, ValueError):
        raise TypeError(f"size: {size!r} is no size: give (width, height) in pixels, whole numbers") from None


def _check_spec(name: str, spec: object, *, optional: bool = False) -> None:
    """Refuses what was not made by one of the tables."""
    if not (isinstance(spec, Spec) or optional and spec is None):
        raise TypeError(f"{name}: {spec!r} is no {name}: give one of bilux.{name}s (bilux.{name}s() lists them)")


def _window(crop: tuple[int, int, int, int] | None) -> tuple[int, int, int, int] | None:
    """The window, if it is one."""
    if crop is None:
        return None
    try:
        x, y, width, height = (operator.index(side) for side in crop)
    except (TypeError, ValueError):
        raise TypeError(f"crop: {crop!r} is no window: give (x, y, width, height) in pixels") from None
    if not all(0 <= side < 1 << 32 for side in (x, y, width, height)):
        raise ValueError(f"crop: {crop!r} does not lie within a picture: give (x, y, width, height) in pixels")
    return x, y, width, height


def _bytes(max_memory: int) -> int:
    """A number of bytes."""
    try:
        number = operator.index(max_memory)
    except TypeError:
        raise TypeError(f"max_memory: {max_memory!r} is no number of bytes: give a whole number, such as 8 << 30") from None
    if not 0 < number < 1 << 64:
        raise ValueError(f"max_memory: {number} is no number of bytes: 8 << 30 is the default")
    return number


def _denoise(denoise: bool | str | None) -> str | None:
    """The denoiser as settings have it."""
    if isinstance(denoise, (bool, np.bool_)):
        return "auto" if denoise else "off"
    return denoise


def _layers(aov: Sequence[str] | str | None, labels: bool = False) -> list[str]:
    """The names of layers."""
    named = [aov] if isinstance(aov, str) else list(aov or ())
    labels = labels or "labels" in named
    named = [name for name in named if name != "labels"]
    return named + [name for name in LABELS if labels and name not in named]


def _colored(material: Spec | None, colors: ArrayLike | None) -> tuple[Spec | None, ArrayLike | None]:
    """The material, and colours proportional to light."""
    if colors is None:
        return material, None
    array = np.asarray(colors)
    if array.dtype == np.uint8:
        shown = array[..., :3] / 255.0
        array = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return Spec("materials", "diffuse", {"reflectance": 1.0}) if material is None else material, array


def _several(group: int | Sequence[int]) -> Sequence[int]:
    """The objects of a group."""
    return list(group) if np.iterable(group) else [operator.index(group)]


def _range(first: int, count: int) -> range:
    return range(first, first + count)


def load(
    file: Path | bytes | bytearray | memoryview | BinaryIO,
    *,
    format: str | None = None,
    folder: Path | None = None,
    time: float = 0.0,
    animation: str | None = None,
    variant: str | None = None,
    subdivide: Literal["catmull-clark", "loop", "bilinear"] | None = None,
    definitions: Mapping[str, object] | None = None,
    glass: Literal["auto", "thin", "solid"] = "auto",
    light_radius: float = 0.0,
    max_memory: int = MAX_MEMORY,
    allow_outside: bool = False,
    strict: bool = False,
) -> Scene:
    """Reads a scene file.

    Args:
        file: a scene, a model, a point cloud or an archive with one, in any format of `bilux.formats`: a path, bytes, or a
            file that is open in binary mode.
        format: its format (`bilux.formats`), such as "obj". By default, its extension or its first bytes say it.
        folder: the folder of the files that it refers to; by default its own, if it has one.
        time: what moves is as at this time, in seconds.
        animation: the animation to play, by its name or number; by default the first.
        variant: the variant of materials to show, by its name or number.
        subdivide: the scheme by which polygons of a file that states none (OBJ, PLY, OFF) are the cage of a subdivision
            surface; by default they stay as they are.
        definitions: values for variables of the scene, in place of their defaults (Mitsuba).
        glass: how to read glass whose thickness the file does not give.
        light_radius: the radius of point lights in metres, which softens their shadows.
        max_memory: bytes that reading may take.
        allow_outside: whether the file may refer to files outside its own folder.
        strict: whether warnings are errors.

    Returns:
        the scene. What is odd about the file is a `SceneWarning`.

    Raises:
        FileNotFoundError: if there is no such file.
        FormatError: if it is broken, or in no known format.
        SceneError: if a name or a value in it is wrong.
        TypeError: if it is no file, or one that is open as text.

    Example:
        >>> bilux.load("model.glb").render(size=(64, 48), spp=1).save("model.png")
        >>> len(bilux.load(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", format="obj"))
        1
    """
    scene: Scene = Scene._load(
        file,
        format=format,
        folder=folder,
        time=time,
        animation=animation,
        variant=variant,
        subdivide=subdivide,
        definitions=[(name, str(value)) for name, value in (definitions or {}).items()],
        glass=glass,
        light_radius=light_radius,
        max_memory=_bytes(max_memory),
        allow_outside=allow_outside,
        strict=strict,
    )
    scene._time = time
    return scene


def generate(kind: str, **parameters: Any) -> Scene:
    """Makes a built-in scene.

    Args:
        kind: its name (`bilux.generators`), such as "cornell" or "trio".
        **parameters: its parameters, as the table lists them.

    Raises:
        SceneError: if there is no such scene, or a parameter is wrong.

    Example:
        >>> bilux.generate("cornell").render(size=64, spp=1).width
        64
    """
    scene: Scene = Scene._generate(kind, parameters)
    return scene
