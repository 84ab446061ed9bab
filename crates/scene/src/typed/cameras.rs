//! Cameras as Rust types. Generated from their table by `cargo xtask docs`; do not edit by hand.

typed! {
    /// Perspective camera: a pinhole, or a thin lens if it has an aperture.
    Perspective = "perspective" {
        /// Position of the eye (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// The point at the centre of the picture (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Vertical field of view (degrees); from 0.01 to 179; default `40`.
        fov: impl Into<f64> as super::number,
        /// Aspect ratio (width over height) that stays fully visible in narrower pictures too; 0 to fix only the height; from 0 to 1000; default `0`.
        frame: impl Into<f64> as super::number,
        /// Radius of the aperture; 0 for a pinhole (m); from 0 to 1e6; default `0`.
        aperture: impl Into<f64> as super::number,
        /// Focus distance; 0 for the distance of look_at (m); from 0 to 1e9; default `0`.
        focus: impl Into<f64> as super::number,
        /// Blades of the aperture: highlights out of focus have as many corners; 0 for a round one; from 0 to 64; default `0`.
        blades: i32,
        /// By how much the blades are turned counterclockwise (degrees); from -360 to 360; default `0`.
        blades_rotation: impl Into<f64> as super::number,
        /// By how much the plane of focus leans back on the right side of the picture, as behind a tilted lens (degrees); from -89 to 89; default `0`.
        focus_tilt_x: impl Into<f64> as super::number,
        /// By how much it leans back at the top; near 90 it is like a floor (degrees); from -89 to 89; default `0`.
        focus_tilt_y: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from its left edge, in widths; from -100 to 100; default `0.5`.
        principal_x: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from its upper edge, in heights; from -100 to 100; default `0.5`.
        principal_y: impl Into<f64> as super::number,
        /// Lens shift to the right, in longer sides of the picture, as in Blender; from -100 to 100; default `0`.
        shift_x: impl Into<f64> as super::number,
        /// Lens shift upwards, in longer sides of the picture, as in Blender; from -100 to 100; default `0`.
        shift_y: impl Into<f64> as super::number,
        /// Width of a pixel over its height: fy / fx of a camera matrix; from 0.001 to 1000; default `1`.
        pixel_aspect: impl Into<f64> as super::number,
        /// By how much the picture leans to the right downwards: s / fx of a camera matrix; from -100 to 100; default `0`.
        skew: impl Into<f64> as super::number,
        /// The picture of one eye, or of both: the left one left of the right one, or above it: `none`, `left`, `right`, `side-by-side`, `over-under`; default `none`.
        stereo: &str,
        /// Distance between the two eyes of stereo (m); from 0 to 1e6; default `0.064`.
        eye_distance: impl Into<f64> as super::number,
        /// Distance at which both eyes of stereo see a point at the same place; 0 for parallel axes (m); from 0 to 1e9; default `0`.
        convergence: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
    }
    /// Orthographic camera: parallel rays.
    Orthographic = "orthographic" {
        /// The centre of the film (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// The point at the centre of the picture (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Height of the view (m); from 1e-9 to 1e9; default `2`.
        height: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
    }
    /// Not an eye but a meter: each pixel is the light that its part of a flat rectangle receives, over π, which is the radiance of white matt paper there; only for path and auto.
    Irradiance = "irradiance" {
        /// The centre of the rectangle (m); default `0 0 0`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// A point straight ahead of the centre, on the side that receives light (m); default `0 1 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture, which is that of an eye before the rectangle (m); default `0 0 -1`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Height of the rectangle; its width follows from the shape of the picture (m); from 1e-9 to 1e9; default `2`.
        height: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
    }
    /// Fisheye lens: a circle of up to everything around it, black outside of the circle.
    Fisheye = "fisheye" {
        /// Position of the eye (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// The point at the centre of the picture (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// How the distance from the centre grows with the angle θ: θ, sin θ/2, tan θ/2 or sin θ: `equidistant`, `equisolid`, `stereographic`, `orthographic`; default `equidistant`.
        mapping: &str,
        /// Field of view, from one side of the circle to the other; at most 180 if orthographic (degrees); from 1 to 359; default `180`.
        fov: impl Into<f64> as super::number,
        /// Whether the circle is as wide as the shorter side of the picture, or reaches its corners: `shorter`, `diagonal`; default `shorter`.
        fit: &str,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
    }
    /// Panorama: everything around the eye, for viewers, virtual reality and environment maps.
    Panorama = "panorama" {
        /// Position of the eye (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// The point at the centre of the picture (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Equirectangular: longitude and latitude; cylindrical: verticals stay straight; cube: the six faces of a cube in a row (right, left, up, down, front, back): `equirectangular`, `cylindrical`, `cube`; default `equirectangular`.
        mapping: &str,
        /// Horizontal field of view; not for cubes (degrees); from 1 to 360; default `360`.
        fov_x: impl Into<f64> as super::number,
        /// Vertical field of view, below 180 if cylindrical; not for cubes (degrees); from 1 to 180; default `180`.
        fov: impl Into<f64> as super::number,
        /// The picture of one eye, or of both: the left one left of the right one, or above it: `none`, `left`, `right`, `side-by-side`, `over-under`; default `none`.
        stereo: &str,
        /// Distance between the two eyes of stereo (m); from 0 to 1e6; default `0.064`.
        eye_distance: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
    }
    /// Camera of OpenCV: a camera matrix in pixels, radial, tangential and thin prism distortion.
    Opencv = "opencv" {
        /// Position of the eye (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// A point on the axis (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Width of the pictures that it was calibrated with, in pixels; from 1 to 1048576; default `640`.
        width: i32,
        /// Height of the pictures that it was calibrated with, in pixels; from 1 to 1048576; default `480`.
        height: i32,
        /// Focal length in widths of a pixel (pixels); from 0.001 to 1e9; default `525`.
        fx: impl Into<f64> as super::number,
        /// Focal length in heights of a pixel (pixels); from 0.001 to 1e9; default `525`.
        fy: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from the centre of the leftmost pixels (pixels); from -1e9 to 1e9; default `319.5`.
        cx: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from the centre of the uppermost pixels (pixels); from -1e9 to 1e9; default `239.5`.
        cy: impl Into<f64> as super::number,
        /// By how much the picture leans to the right downwards: K\[0]\[1] (pixels); from -1e9 to 1e9; default `0`.
        skew: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
        /// Radial distortion, by the square of the distance from the axis; from -1e9 to 1e9; default `0`.
        k1: impl Into<f64> as super::number,
        /// Radial distortion, by its 4th power; from -1e9 to 1e9; default `0`.
        k2: impl Into<f64> as super::number,
        /// Radial distortion, by its 6th power; from -1e9 to 1e9; default `0`.
        k3: impl Into<f64> as super::number,
        /// What radial distortion is divided by, by the square of the distance from the axis; from -1e9 to 1e9; default `0`.
        k4: impl Into<f64> as super::number,
        /// What radial distortion is divided by, by its 4th power; from -1e9 to 1e9; default `0`.
        k5: impl Into<f64> as super::number,
        /// What radial distortion is divided by, by its 6th power; from -1e9 to 1e9; default `0`.
        k6: impl Into<f64> as super::number,
        /// Tangential distortion, downwards; from -1e9 to 1e9; default `0`.
        p1: impl Into<f64> as super::number,
        /// Tangential distortion, to the right; from -1e9 to 1e9; default `0`.
        p2: impl Into<f64> as super::number,
        /// Thin prism distortion to the right, by the square of the distance from the axis; from -1e9 to 1e9; default `0`.
        s1: impl Into<f64> as super::number,
        /// Thin prism distortion to the right, by its 4th power; from -1e9 to 1e9; default `0`.
        s2: impl Into<f64> as super::number,
        /// Thin prism distortion downwards, by the square of the distance from the axis; from -1e9 to 1e9; default `0`.
        s3: impl Into<f64> as super::number,
        /// Thin prism distortion downwards, by its 4th power; from -1e9 to 1e9; default `0`.
        s4: impl Into<f64> as super::number,
    }
    /// Fisheye camera of OpenCV: a camera matrix in pixels, and distances from the axis as a polynomial of angles.
    OpencvFisheye = "opencv-fisheye" {
        /// Position of the eye (m); default `0 0 5`.
        position: impl Into<bilux_math::DVec3> as super::vector,
        /// A point on the axis (m); default `0 0 0`.
        look_at: impl Into<bilux_math::DVec3> as super::vector,
        /// The up direction in the picture (m); default `0 1 0`.
        up: impl Into<bilux_math::DVec3> as super::vector,
        /// Width of the pictures that it was calibrated with, in pixels; from 1 to 1048576; default `640`.
        width: i32,
        /// Height of the pictures that it was calibrated with, in pixels; from 1 to 1048576; default `480`.
        height: i32,
        /// Focal length in widths of a pixel (pixels); from 0.001 to 1e9; default `525`.
        fx: impl Into<f64> as super::number,
        /// Focal length in heights of a pixel (pixels); from 0.001 to 1e9; default `525`.
        fy: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from the centre of the leftmost pixels (pixels); from -1e9 to 1e9; default `319.5`.
        cx: impl Into<f64> as super::number,
        /// Where the axis meets the picture, from the centre of the uppermost pixels (pixels); from -1e9 to 1e9; default `239.5`.
        cy: impl Into<f64> as super::number,
        /// By how much the picture leans to the right downwards: K\[0]\[1] (pixels); from -1e9 to 1e9; default `0`.
        skew: impl Into<f64> as super::number,
        /// Mirror left and right, as left-handed cameras do; default `false`.
        mirrored: bool,
        /// By the 3rd power of the angle from the axis; from -1e9 to 1e9; default `0`.
        k1: impl Into<f64> as super::number,
        /// By its 5th power; from -1e9 to 1e9; default `0`.
        k2: impl Into<f64> as super::number,
        /// By its 7th power; from -1e9 to 1e9; default `0`.
        k3: impl Into<f64> as super::number,
        /// By its 9th power; from -1e9 to 1e9; default `0`.
        k4: impl Into<f64> as super::number,
    }
}
