"""The functions that make materials, lights and cameras, with their parameters, for editors and checkers of types.

Generated from the tables by `cargo xtask docs`; do not edit by hand.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex, TypedDict

from ._tables import Cameras, Makers, made

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._bilux import Spec


class MaterialPhong(TypedDict, total=False):
    """Parameters of `phong`."""

    ka: Any
    kd: Any
    ks: Any
    kt: Any
    exponent: SupportsFloat
    reflectivity: SupportsFloat
    eta: SupportsFloat
    absorption: ArrayLike
    thin: bool
    gloss: SupportsFloat
    translucency: SupportsFloat
    emission: Any
    emission_scale: ArrayLike
    emission_sides: str
    opacity: Any
    normal: Any
    normal_scale: SupportsFloat


class MaterialDiffuse(TypedDict, total=False):
    """Parameters of `diffuse`."""

    reflectance: Any
    roughness: Any
    emission: Any
    emission_scale: ArrayLike
    emission_sides: str
    opacity: Any
    visible_sides: str
    normal: Any
    normal_scale: SupportsFloat


class MaterialTranslucent(TypedDict, total=False):
    """Parameters of `translucent`."""

    reflectance: Any
    transmittance: Any
    emission: Any
    emission_scale: ArrayLike
    emission_sides: str
    opacity: Any
    normal: Any
    normal_scale: SupportsFloat


class MaterialMirror(TypedDict, total=False):
    """Parameters of `mirror`."""

    reflectance: Any
    gloss: SupportsFloat
    emission: Any
    emission_scale: ArrayLike
    emission_sides: str
    opacity: Any
    visible_sides: str
    normal: Any
    normal_scale: SupportsFloat


class MaterialConductor(TypedDict, total=False):
    """Parameters of `conductor`."""

    metal: str
    eta: ArrayLike
    k: ArrayLike
    reflectance: Any
    edge: ArrayLike
    roughness: Any
    anisotropy: Any
    rotation: SupportsFloat
    distribution: str
    opacity: Any
    visible_sides: str
    normal: Any
    normal_scale: SupportsFloat


class MaterialDielectric(TypedDict, total=False):
    """Parameters of `dielectric`."""

    glass: str
    eta: SupportsFloat
    dispersion: SupportsFloat
    tint: Any
    absorption: ArrayLike
    scattering: ArrayLike
    phase: str
    scattering_anisotropy: SupportsFloat
    draine_alpha: SupportsFloat
    droplet_diameter: SupportsFloat
    priority: SupportsIndex
    thin: bool
    roughness: Any
    anisotropy: Any
    rotation: SupportsFloat
    distribution: str
    gloss: SupportsFloat
    translucency: SupportsFloat
    opacity: Any
    normal: Any
    normal_scale: SupportsFloat


class MaterialInterface(TypedDict, total=False):
    """Parameters of `interface`."""

    absorption: ArrayLike
    scattering: ArrayLike
    density: Any
    phase: str
    scattering_anisotropy: SupportsFloat
    draine_alpha: SupportsFloat
    droplet_diameter: SupportsFloat
    medium_emission: ArrayLike
    medium_emission_grid: Any
    temperature: Any
    temperature_scale: SupportsFloat
    temperature_norm: str
    priority: SupportsIndex


class MaterialPrincipled(TypedDict, total=False):
    """Parameters of `principled`."""

    base_color: Any
    base_diffuse_roughness: Any
    base_metalness: Any
    specular_weight: Any
    specular_color: Any
    specular_roughness: Any
    specular_ior: Any
    specular_roughness_anisotropy: Any
    anisotropy_rotation: Any
    transmission_weight: Any
    transmission_color: Any
    transmission_depth: SupportsFloat
    transmission_scatter: ArrayLike
    transmission_scatter_anisotropy: SupportsFloat
    transmission_dispersion_scale: SupportsFloat
    transmission_dispersion_abbe_number: SupportsFloat
    subsurface_weight: Any
    subsurface_color: Any
    subsurface_radius: SupportsFloat
    subsurface_radius_scale: ArrayLike
    subsurface_scatter_anisotropy: SupportsFloat
    thin_walled: bool
    priority: SupportsIndex
    coat_weight: Any
    coat_color: Any
    coat_roughness: Any
    coat_ior: Any
    coat_normal: Any
    coat_normal_scale: SupportsFloat
    fuzz_weight: Any
    fuzz_color: Any
    fuzz_roughness: Any
    diffuse_transmission_weight: Any
    diffuse_transmission_color: Any
    thin_film_weight: Any
    thin_film_thickness: Any
    thin_film_ior: Any
    emission: Any
    emission_scale: ArrayLike
    emission_sides: str
    opacity: Any
    visible_sides: str
    normal: Any
    normal_scale: SupportsFloat


class MaterialMix(TypedDict, total=False):
    """Parameters of `mix`."""

    a: Any
    b: Any
    amount: Any
    opacity: Any
    normal: Any
    normal_scale: SupportsFloat


class MaterialMakers(Makers):
    """The functions of a table; see `Makers`."""

    @made
    def phong(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialPhong],
    ) -> Spec:
        raise NotImplementedError

    @made
    def diffuse(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialDiffuse],
    ) -> Spec:
        raise NotImplementedError

    @made
    def translucent(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialTranslucent],
    ) -> Spec:
        raise NotImplementedError

    @made
    def mirror(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialMirror],
    ) -> Spec:
        raise NotImplementedError

    @made
    def conductor(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialConductor],
    ) -> Spec:
        raise NotImplementedError

    @made
    def dielectric(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialDielectric],
    ) -> Spec:
        raise NotImplementedError

    @made
    def interface(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialInterface],
    ) -> Spec:
        raise NotImplementedError

    @made
    def principled(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialPrincipled],
    ) -> Spec:
        raise NotImplementedError

    @made
    def mix(
        self,
        *,
        name: str = "",
        **parameters: Unpack[MaterialMix],
    ) -> Spec:
        raise NotImplementedError


class LightPoint(TypedDict, total=False):
    """Parameters of `point`."""

    position: ArrayLike
    intensity: ArrayLike
    classic: ArrayLike
    group: str


class LightDirectional(TypedDict, total=False):
    """Parameters of `directional`."""

    direction: ArrayLike
    irradiance: ArrayLike
    diameter: SupportsFloat
    classic: ArrayLike
    group: str


class LightSpot(TypedDict, total=False):
    """Parameters of `spot`."""

    position: ArrayLike
    look_at: ArrayLike
    intensity: ArrayLike
    angle: SupportsFloat
    inner_angle: SupportsFloat
    classic: ArrayLike
    group: str


class LightLuminaire(TypedDict, total=False):
    """Parameters of `luminaire`."""

    position: ArrayLike
    direction: ArrayLike
    c0: ArrayLike
    distribution: Any
    flux: ArrayLike
    scale: ArrayLike
    classic: ArrayLike
    group: str


class LightRect(TypedDict, total=False):
    """Parameters of `rect`."""

    position: ArrayLike
    edge_u: ArrayLike
    edge_v: ArrayLike
    radiance: ArrayLike
    intensity: ArrayLike
    sides: str
    classic: ArrayLike
    group: str


class LightSphere(TypedDict, total=False):
    """Parameters of `sphere`."""

    position: ArrayLike
    radius: SupportsFloat
    radiance: ArrayLike
    intensity: ArrayLike
    classic: ArrayLike
    group: str


class LightEnvironment(TypedDict, total=False):
    """Parameters of `environment`."""

    radiance: Any
    scale: ArrayLike
    rotation: SupportsFloat
    zenith: ArrayLike
    horizon: ArrayLike
    ground: ArrayLike
    backdrop: bool
    group: str


class LightSky(TypedDict, total=False):
    """Parameters of `sky`."""

    elevation: SupportsFloat
    azimuth: SupportsFloat
    turbidity: SupportsFloat
    ground: ArrayLike
    scale: ArrayLike
    sun_scale: SupportsFloat
    sun_diameter: SupportsFloat
    group: str


class LightCieSky(TypedDict, total=False):
    """Parameters of `cie-sky`."""

    standard: SupportsIndex
    elevation: SupportsFloat
    azimuth: SupportsFloat
    irradiance: ArrayLike
    zenith: ArrayLike
    sun: ArrayLike
    sun_diameter: SupportsFloat
    ground: ArrayLike
    group: str


class LightPerezSky(TypedDict, total=False):
    """Parameters of `perez-sky`."""

    elevation: SupportsFloat
    azimuth: SupportsFloat
    direct: ArrayLike
    diffuse: ArrayLike
    clearness: SupportsFloat
    brightness: SupportsFloat
    sun_diameter: SupportsFloat
    ground: ArrayLike
    group: str


class LightAmbient(TypedDict, total=False):
    """Parameters of `ambient`."""

    colour: ArrayLike
    group: str


class LightMakers(Makers):
    """The functions of a table; see `Makers`."""

    @made
    def point(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightPoint],
    ) -> Spec:
        raise NotImplementedError

    @made
    def directional(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightDirectional],
    ) -> Spec:
        raise NotImplementedError

    @made
    def spot(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightSpot],
    ) -> Spec:
        raise NotImplementedError

    @made
    def luminaire(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightLuminaire],
    ) -> Spec:
        raise NotImplementedError

    @made
    def rect(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightRect],
    ) -> Spec:
        raise NotImplementedError

    @made
    def sphere(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightSphere],
    ) -> Spec:
        raise NotImplementedError

    @made
    def environment(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightEnvironment],
    ) -> Spec:
        raise NotImplementedError

    @made
    def sky(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightSky],
    ) -> Spec:
        raise NotImplementedError

    @made
    def cie_sky(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightCieSky],
    ) -> Spec:
        raise NotImplementedError

    @made
    def perez_sky(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightPerezSky],
    ) -> Spec:
        raise NotImplementedError

    @made
    def ambient(
        self,
        *,
        name: str = "",
        **parameters: Unpack[LightAmbient],
    ) -> Spec:
        raise NotImplementedError


class CameraPerspective(TypedDict, total=False):
    """Parameters of `perspective`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    fov: SupportsFloat
    frame: SupportsFloat
    aperture: SupportsFloat
    focus: SupportsFloat
    blades: SupportsIndex
    blades_rotation: SupportsFloat
    focus_tilt_x: SupportsFloat
    focus_tilt_y: SupportsFloat
    principal_x: SupportsFloat
    principal_y: SupportsFloat
    shift_x: SupportsFloat
    shift_y: SupportsFloat
    pixel_aspect: SupportsFloat
    skew: SupportsFloat
    stereo: str
    eye_distance: SupportsFloat
    convergence: SupportsFloat
    mirrored: bool


class CameraOrthographic(TypedDict, total=False):
    """Parameters of `orthographic`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    height: SupportsFloat
    mirrored: bool


class CameraIrradiance(TypedDict, total=False):
    """Parameters of `irradiance`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    height: SupportsFloat
    mirrored: bool


class CameraFisheye(TypedDict, total=False):
    """Parameters of `fisheye`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    mapping: str
    fov: SupportsFloat
    fit: str
    mirrored: bool


class CameraPanorama(TypedDict, total=False):
    """Parameters of `panorama`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    mapping: str
    fov_x: SupportsFloat
    fov: SupportsFloat
    stereo: str
    eye_distance: SupportsFloat
    mirrored: bool


class CameraOpencv(TypedDict, total=False):
    """Parameters of `opencv`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    width: SupportsIndex
    height: SupportsIndex
    fx: SupportsFloat
    fy: SupportsFloat
    cx: SupportsFloat
    cy: SupportsFloat
    skew: SupportsFloat
    mirrored: bool
    k1: SupportsFloat
    k2: SupportsFloat
    k3: SupportsFloat
    k4: SupportsFloat
    k5: SupportsFloat
    k6: SupportsFloat
    p1: SupportsFloat
    p2: SupportsFloat
    s1: SupportsFloat
    s2: SupportsFloat
    s3: SupportsFloat
    s4: SupportsFloat


class CameraOpencvFisheye(TypedDict, total=False):
    """Parameters of `opencv-fisheye`."""

    position: ArrayLike
    look_at: ArrayLike
    up: ArrayLike
    width: SupportsIndex
    height: SupportsIndex
    fx: SupportsFloat
    fy: SupportsFloat
    cx: SupportsFloat
    cy: SupportsFloat
    skew: SupportsFloat
    mirrored: bool
    k1: SupportsFloat
    k2: SupportsFloat
    k3: SupportsFloat
    k4: SupportsFloat


class CameraMakers(Cameras):
    """The functions of a table; see `Cameras`."""

    @made
    def perspective(
        self,
        *,
        name: str = "",
        **parameters: Unpack[CameraPerspective],
    ) -> Spec:
        raise NotImplementedError

    @made
    def orthographic(
        self,
        *,
        name: str = "",
        **parameters: Unpack[CameraOrthographic],
    ) -> Spec:
        raise NotImplementedError

    @made
    def irradiance(
        self,
        *,
        name: str = "",
        **parameters: Unpack[CameraIrradiance],
    ) -> Spec:
        raise NotImplementedError

    @made
    def fisheye(
        self,
        *,
        name: str = "",
        **parameters: Unpack[CameraFisheye],
    ) -> Spec:
        raise NotImplementedError

    @made
    def panorama(
        self,
        *,
        name: str = "",
        **parameters: Unpack[CameraPanorama],
    ) -> Spec:
        raise NotImplementedError

    @made
    def opencv(
        self,
K: ArrayLike | None = None,
        world_to_camera: ArrayLike | None = None,
        *,
        camera_to_world: ArrayLike | None = None,
        distortion: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        R: ArrayLike | None = None,
        t: ArrayLike | None = None,
        beyond: str = "error",
        name: str = "",
        **parameters: Unpack[CameraOpencv],
    ) -> Spec:
        raise NotImplementedError

    @made
    def opencv_fisheye(
        self,
K: ArrayLike | None = None,
        world_to_camera: ArrayLike | None = None,
        *,
        camera_to_world: ArrayLike | None = None,
        distortion: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        R: ArrayLike | None = None,
        t: ArrayLike | None = None,
        beyond: str = "error",
        name: str = "",
        **parameters: Unpack[CameraOpencvFisheye],
    ) -> Spec:
        raise NotImplementedError


cameras = CameraMakers("cameras", "kinds of camera")
lights = LightMakers("lights", "light sources")
materials = MaterialMakers("materials", "what surfaces are made of")
