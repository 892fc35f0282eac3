//! Accelerogram files → evenly spaced ground accelerations in m/s².
