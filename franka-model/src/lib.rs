//! Kinematics, dynamics and limits of Franka robots
