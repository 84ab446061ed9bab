//! Pictures with named channels: PNG, EXR, HDR, PFM, PPM, tone mapping and error metrics.
