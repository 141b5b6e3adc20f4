-- Dissector for Franka robots: the command streams of the arm (TCP 1337), the Hand (1338) and the vacuum gripper (1339),
-- and the datagrams on the UDP port that each Connect announces. Protocols 10 (Franka Research 3) and 5 (Franka Emika
-- Robot). For Wireshark and tshark 3.4 and later:
--
--   tshark -X lua_script:franka.lua -r capture.pcapng -Y franka
--   cp franka.lua ~/.local/lib/wireshark/plugins/        for all captures
--
-- Display filters: `franka.request.*`, `franka.reply.*`, `franka.state.*`, `franka.command.*`; those of the Hand begin with
-- `franka.hand.`, those of the vacuum gripper with `franka.vacuum.`. A datagram is known only if its Connect is in the
-- capture.

-- begin of the tables: written by a test from the layouts that franka-proto is tested with
local PROTOCOLS = {
  {
    name = "robot", prefix = "franka", version = 10, port = 1337, header = 12,
    state = "RobotState", command = "RobotCommand",
    commands = {
      [0] = { "Connect", "Connect::Request", "Connect::Response" },
      [1] = { "Move", "Move::Request", "Move::Response", long = true },
      [2] = { "StopMove", nil, "StopMove::Response" },
      [3] = { "SetCollisionBehavior", "SetCollisionBehavior::Request", "SetCollisionBehavior::Response" },
      [4] = { "SetJointImpedance", "SetJointImpedance::Request", "SetJointImpedance::Response" },
      [5] = { "SetCartesianImpedance", "SetCartesianImpedance::Request", "SetCartesianImpedance::Response" },
      [6] = { "SetGuidingMode", "SetGuidingMode::Request", "SetGuidingMode::Response" },
      [7] = { "SetEEToK", "SetEEToK::Request", "SetEEToK::Response" },
      [8] = { "SetNEToEE", "SetNEToEE::Request", "SetNEToEE::Response" },
      [9] = { "SetLoad", "SetLoad::Request", "SetLoad::Response" },
      [10] = { "AutomaticErrorRecovery", nil, "AutomaticErrorRecovery::Response", long = true },
      [11] = { "GetRobotModel", nil, "GetRobotModel::Response" },
    },
    enums = {
      ["state::MotionGeneratorMode"] = {
        [0] = "Idle", [1] = "JointPosition", [2] = "JointVelocity", [3] = "CartesianPosition",
        [4] = "CartesianVelocity", [5] = "None",
      },
      ["state::ControllerMode"] = {
        [0] = "JointImpedance", [1] = "CartesianImpedance", [2] = "ExternalController", [3] = "Other",
      },
      ["state::RobotMode"] = {
        [0] = "Other", [1] = "Idle", [2] = "Move", [3] = "Guiding", [4] = "Reflex", [5] = "UserStopped",
        [6] = "AutomaticErrorRecovery",
      },
      ["Command"] = {
        [0] = "Connect", [1] = "Move", [2] = "StopMove", [3] = "SetCollisionBehavior", [4] = "SetJointImpedance",
        [5] = "SetCartesianImpedance", [6] = "SetGuidingMode", [7] = "SetEEToK", [8] = "SetNEToEE", [9] = "SetLoad",
        [10] = "AutomaticErrorRecovery", [11] = "GetRobotModel",
      },
      ["CommandBase::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "CommandRejectedDueToActivatedSafetyFunctions",
      },
      ["GetterSetterCommandBase::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "InvalidArgumentRejected",
        [3] = "CommandRejectedDueToActivatedSafetyFunctions",
      },
      ["Connect::Status"] = { [0] = "Success", [1] = "IncompatibleLibraryVersion", },
      ["Move::ControllerMode"] = { [0] = "JointImpedance", [1] = "CartesianImpedance", [2] = "ExternalController", },
      ["Move::MotionGeneratorMode"] = {
        [0] = "JointPosition", [1] = "JointVelocity", [2] = "CartesianPosition", [3] = "CartesianVelocity",
        [4] = "None",
      },
      ["Move::Status"] = {
        [0] = "Success", [1] = "MotionStarted", [2] = "Preempted", [3] = "PreemptedDueToActivatedSafetyFunctions",
        [4] = "CommandRejectedDueToActivatedSafetyFunctions", [5] = "CommandNotPossibleRejected",
        [6] = "StartAtSingularPoseRejected", [7] = "InvalidArgumentRejected", [8] = "ReflexAborted",
        [9] = "EmergencyAborted", [10] = "InputErrorAborted", [11] = "Aborted",
      },
      ["StopMove::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "CommandRejectedDueToActivatedSafetyFunctions",
        [3] = "EmergencyAborted", [4] = "ReflexAborted", [5] = "Aborted",
      },
      ["AutomaticErrorRecovery::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "CommandRejectedDueToActivatedSafetyFunctions",
        [3] = "ManualErrorRecoveryRequiredRejected", [4] = "ReflexAborted", [5] = "EmergencyAborted", [6] = "Aborted",
      },
    },
    structs = {
      ["RobotState"] = {
        { "message_id", "u64", 1 }, { "O_T_EE", "f32", 16 }, { "O_T_EE_d", "f32", 16 }, { "F_T_EE", "f32", 16 },
        { "EE_T_K", "f32", 16 }, { "F_T_NE", "f32", 16 }, { "NE_T_EE", "f32", 16 }, { "m_ee", "f32", 1 },
        { "I_ee", "f32", 9 }, { "F_x_Cee", "f32", 3 }, { "m_load", "f32", 1 }, { "I_load", "f32", 9 },
        { "F_x_Cload", "f32", 3 }, { "elbow", "f32", 2 }, { "elbow_d", "f32", 2 }, { "tau_J", "f32", 7 },
        { "tau_J_d", "f32", 7 }, { "dtau_J", "f32", 7 }, { "q", "f32", 7 }, { "q_d", "f32", 7 }, { "dq", "f32", 7 },
        { "dq_d", "f32", 7 }, { "ddq_d", "f32", 7 }, { "joint_contact", "f32", 7 }, { "cartesian_contact", "f32", 6 },
        { "joint_collision", "f32", 7 }, { "cartesian_collision", "f32", 6 }, { "tau_ext_hat_filtered", "f32", 7 },
        { "O_F_ext_hat_K", "f32", 6 }, { "K_F_ext_hat_K", "f32", 6 }, { "O_dP_EE_d", "f32", 6 },
        { "O_ddP_O", "f32", 3 }, { "elbow_c", "f32", 2 }, { "delbow_c", "f32", 2 }, { "ddelbow_c", "f32", 2 },
        { "O_T_EE_c", "f32", 16 }, { "O_dP_EE_c", "f32", 6 }, { "O_ddP_EE_c", "f32", 6 }, { "theta", "f32", 7 },
        { "dtheta", "f32", 7 }, { "accelerometer_top", "f32", 18 }, { "accelerometer_bottom", "f32", 18 },
        { "motion_generator_mode", "u8", 1, "state::MotionGeneratorMode" },
        { "controller_mode", "u8", 1, "state::ControllerMode" }, { "errors", "bool", 41 },
        { "reflex_reason", "bool", 41 }, { "robot_mode", "u8", 1, "state::RobotMode" },
        { "control_command_success_rate", "f32", 1 },
      },
      ["RobotCommand"] = {
        { "message_id", "u64", 1 }, { "motion.q_c", "f64", 7 }, { "motion.dq_c", "f64", 7 },
        { "motion.O_T_EE_c", "f64", 16 }, { "motion.O_dP_EE_c", "f64", 6 }, { "motion.elbow_c", "f64", 2 },
        { "motion.valid_elbow", "bool", 1 }, { "motion.motion_generation_finished", "bool", 1 },
        { "control.tau_J_d", "f64", 7 }, { "control.torque_command_finished", "bool", 1 },
      },
      ["Connect::Request"] = { { "version", "u16", 1 }, { "udp_port", "u16", 1 }, },
      ["Connect::Response"] = { { "status", "u8", 1, "Connect::Status" }, { "version", "u16", 1 }, },
      ["Move::Request"] = {
        { "controller_mode", "u32", 1, "Move::ControllerMode" },
        { "motion_generator_mode", "u32", 1, "Move::MotionGeneratorMode" },
        { "maximum_path_deviation.translation", "f64", 1 }, { "maximum_path_deviation.rotation", "f64", 1 },
        { "maximum_path_deviation.elbow", "f64", 1 }, { "maximum_goal_pose_deviation.translation", "f64", 1 },
        { "maximum_goal_pose_deviation.rotation", "f64", 1 }, { "maximum_goal_pose_deviation.elbow", "f64", 1 },
        { "use_async_motion_generator", "bool", 1 }, { "maximum_velocity", "f64", 7 },
      },
      ["Move::Response"] = { { "status", "u8", 1, "Move::Status" }, },
      ["StopMove::Response"] = { { "status", "u8", 1, "StopMove::Status" }, },
      ["SetCollisionBehavior::Request"] = {
        { "lower_torque_thresholds_acceleration", "f64", 7 }, { "upper_torque_thresholds_acceleration", "f64", 7 },
        { "lower_torque_thresholds_nominal", "f64", 7 }, { "upper_torque_thresholds_nominal", "f64", 7 },
        { "lower_force_thresholds_acceleration", "f64", 6 }, { "upper_force_thresholds_acceleration", "f64", 6 },
        { "lower_force_thresholds_nominal", "f64", 6 }, { "upper_force_thresholds_nominal", "f64", 6 },
      },
      ["SetCollisionBehavior::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetJointImpedance::Request"] = { { "K_theta", "f64", 7 }, },
      ["SetJointImpedance::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetCartesianImpedance::Request"] = { { "K_x", "f64", 6 }, },
      ["SetCartesianImpedance::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetGuidingMode::Request"] = { { "guiding_mode", "bool", 6 }, { "nullspace", "bool", 1 }, },
      ["SetGuidingMode::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetEEToK::Request"] = { { "EE_T_K", "f64", 16 }, },
      ["SetEEToK::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetNEToEE::Request"] = { { "NE_T_EE", "f64", 16 }, },
      ["SetNEToEE::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetLoad::Request"] = { { "m_load", "f64", 1 }, { "F_x_Cload", "f64", 3 }, { "I_load", "f64", 9 }, },
      ["SetLoad::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["AutomaticErrorRecovery::Response"] = { { "status", "u8", 1, "AutomaticErrorRecovery::Status" }, },
      ["GetRobotModel::Response"] = { { "status", "u8", 1, "CommandBase::Status" }, },
    },
  },
  {
    name = "robot", prefix = "franka", version = 5, port = 1337, header = 12,
    state = "RobotState", command = "RobotCommand",
    commands = {
      [0] = { "Connect", "Connect::Request", "Connect::Response" },
      [1] = { "Move", "Move::Request", "Move::Response", long = true },
      [2] = { "StopMove", nil, "StopMove::Response" },
      [3] = { "GetCartesianLimit", "GetCartesianLimit::Request", "GetCartesianLimit::Response" },
      [4] = { "SetCollisionBehavior", "SetCollisionBehavior::Request", "SetCollisionBehavior::Response" },
      [5] = { "SetJointImpedance", "SetJointImpedance::Request", "SetJointImpedance::Response" },
      [6] = { "SetCartesianImpedance", "SetCartesianImpedance::Request", "SetCartesianImpedance::Response" },
      [7] = { "SetGuidingMode", "SetGuidingMode::Request", "SetGuidingMode::Response" },
      [8] = { "SetEEToK", "SetEEToK::Request", "SetEEToK::Response" },
      [9] = { "SetNEToEE", "SetNEToEE::Request", "SetNEToEE::Response" },
      [10] = { "SetLoad", "SetLoad::Request", "SetLoad::Response" },
      [11] = { "SetFilters", "SetFilters::Request", "SetFilters::Response" },
      [12] = { "AutomaticErrorRecovery", nil, "AutomaticErrorRecovery::Response", long = true },
      [13] = { "LoadModelLibrary", "LoadModelLibrary::Request", "LoadModelLibrary::Response" },
    },
    enums = {
      ["state::MotionGeneratorMode"] = {
        [0] = "Idle", [1] = "JointPosition", [2] = "JointVelocity", [3] = "CartesianPosition",
        [4] = "CartesianVelocity",
      },
      ["state::ControllerMode"] = {
        [0] = "JointImpedance", [1] = "CartesianImpedance", [2] = "ExternalController", [3] = "Other",
      },
      ["state::RobotMode"] = {
        [0] = "Other", [1] = "Idle", [2] = "Move", [3] = "Guiding", [4] = "Reflex", [5] = "UserStopped",
        [6] = "AutomaticErrorRecovery",
      },
      ["Command"] = {
        [0] = "Connect", [1] = "Move", [2] = "StopMove", [3] = "GetCartesianLimit", [4] = "SetCollisionBehavior",
        [5] = "SetJointImpedance", [6] = "SetCartesianImpedance", [7] = "SetGuidingMode", [8] = "SetEEToK",
        [9] = "SetNEToEE", [10] = "SetLoad", [11] = "SetFilters", [12] = "AutomaticErrorRecovery",
        [13] = "LoadModelLibrary",
      },
      ["CommandBase::Status"] = { [0] = "Success", [1] = "CommandNotPossibleRejected", },
      ["GetterSetterCommandBase::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "InvalidArgumentRejected",
      },
      ["Connect::Status"] = { [0] = "Success", [1] = "IncompatibleLibraryVersion", },
      ["Move::ControllerMode"] = { [0] = "JointImpedance", [1] = "CartesianImpedance", [2] = "ExternalController", },
      ["Move::MotionGeneratorMode"] = {
        [0] = "JointPosition", [1] = "JointVelocity", [2] = "CartesianPosition", [3] = "CartesianVelocity",
      },
      ["Move::Status"] = {
        [0] = "Success", [1] = "MotionStarted", [2] = "Preempted", [3] = "CommandNotPossibleRejected",
        [4] = "StartAtSingularPoseRejected", [5] = "InvalidArgumentRejected", [6] = "ReflexAborted",
        [7] = "EmergencyAborted", [8] = "InputErrorAborted", [9] = "Aborted",
      },
      ["StopMove::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "EmergencyAborted", [3] = "ReflexAborted",
        [4] = "Aborted",
      },
      ["AutomaticErrorRecovery::Status"] = {
        [0] = "Success", [1] = "CommandNotPossibleRejected", [2] = "ManualErrorRecoveryRequiredRejected",
        [3] = "ReflexAborted", [4] = "EmergencyAborted", [5] = "Aborted",
      },
      ["LoadModelLibrary::Status"] = { [0] = "Success", [1] = "Error", },
      ["LoadModelLibrary::Architecture"] = { [0] = "X64", [1] = "X86", [2] = "ARM", [3] = "ARM64", },
      ["LoadModelLibrary::System"] = { [0] = "Linux", [1] = "Windows", },
    },
    structs = {
      ["RobotState"] = {
        { "message_id", "u64", 1 }, { "O_T_EE", "f64", 16 }, { "O_T_EE_d", "f64", 16 }, { "F_T_EE", "f64", 16 },
        { "EE_T_K", "f64", 16 }, { "F_T_NE", "f64", 16 }, { "NE_T_EE", "f64", 16 }, { "m_ee", "f64", 1 },
        { "I_ee", "f64", 9 }, { "F_x_Cee", "f64", 3 }, { "m_load", "f64", 1 }, { "I_load", "f64", 9 },
        { "F_x_Cload", "f64", 3 }, { "elbow", "f64", 2 }, { "elbow_d", "f64", 2 }, { "tau_J", "f64", 7 },
        { "tau_J_d", "f64", 7 }, { "dtau_J", "f64", 7 }, { "q", "f64", 7 }, { "q_d", "f64", 7 }, { "dq", "f64", 7 },
        { "dq_d", "f64", 7 }, { "ddq_d", "f64", 7 }, { "joint_contact", "f64", 7 }, { "cartesian_contact", "f64", 6 },
        { "joint_collision", "f64", 7 }, { "cartesian_collision", "f64", 6 }, { "tau_ext_hat_filtered", "f64", 7 },
        { "O_F_ext_hat_K", "f64", 6 }, { "K_F_ext_hat_K", "f64", 6 }, { "O_dP_EE_d", "f64", 6 },
        { "O_ddP_O", "f64", 3 }, { "elbow_c", "f64", 2 }, { "delbow_c", "f64", 2 }, { "ddelbow_c", "f64", 2 },
        { "O_T_EE_c", "f64", 16 }, { "O_dP_EE_c", "f64", 6 }, { "O_ddP_EE_c", "f64", 6 }, { "theta", "f64", 7 },
        { "dtheta", "f64", 7 }, { "motion_generator_mode", "u8", 1, "state::MotionGeneratorMode" },
        { "controller_mode", "u8", 1, "state::ControllerMode" }, { "errors", "bool", 41 },
        { "reflex_reason", "bool", 41 }, { "robot_mode", "u8", 1, "state::RobotMode" },
        { "control_command_success_rate", "f64", 1 },
      },
      ["RobotCommand"] = {
        { "message_id", "u64", 1 }, { "motion.q_c", "f64", 7 }, { "motion.dq_c", "f64", 7 },
        { "motion.O_T_EE_c", "f64", 16 }, { "motion.O_dP_EE_c", "f64", 6 }, { "motion.elbow_c", "f64", 2 },
        { "motion.valid_elbow", "bool", 1 }, { "motion.motion_generation_finished", "bool", 1 },
        { "control.tau_J_d", "f64", 7 },
      },
      ["Connect::Request"] = { { "version", "u16", 1 }, { "udp_port", "u16", 1 }, },
      ["Connect::Response"] = { { "status", "u8", 1, "Connect::Status" }, { "version", "u16", 1 }, },
      ["Move::Request"] = {
        { "controller_mode", "u32", 1, "Move::ControllerMode" },
        { "motion_generator_mode", "u32", 1, "Move::MotionGeneratorMode" },
        { "maximum_path_deviation.translation", "f64", 1 }, { "maximum_path_deviation.rotation", "f64", 1 },
        { "maximum_path_deviation.elbow", "f64", 1 }, { "maximum_goal_pose_deviation.translation", "f64", 1 },
        { "maximum_goal_pose_deviation.rotation", "f64", 1 }, { "maximum_goal_pose_deviation.elbow", "f64", 1 },
      },
      ["Move::Response"] = { { "status", "u8", 1, "Move::Status" }, },
      ["StopMove::Response"] = { { "status", "u8", 1, "StopMove::Status" }, },
      ["SetCollisionBehavior::Request"] = {
        { "lower_torque_thresholds_acceleration", "f64", 7 }, { "upper_torque_thresholds_acceleration", "f64", 7 },
        { "lower_torque_thresholds_nominal", "f64", 7 }, { "upper_torque_thresholds_nominal", "f64", 7 },
        { "lower_force_thresholds_acceleration", "f64", 6 }, { "upper_force_thresholds_acceleration", "f64", 6 },
        { "lower_force_thresholds_nominal", "f64", 6 }, { "upper_force_thresholds_nominal", "f64", 6 },
      },
      ["SetCollisionBehavior::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetJointImpedance::Request"] = { { "K_theta", "f64", 7 }, },
      ["SetJointImpedance::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetCartesianImpedance::Request"] = { { "K_x", "f64", 6 }, },
      ["SetCartesianImpedance::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetGuidingMode::Request"] = { { "guiding_mode", "bool", 6 }, { "nullspace", "bool", 1 }, },
      ["SetGuidingMode::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetEEToK::Request"] = { { "EE_T_K", "f64", 16 }, },
      ["SetEEToK::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetNEToEE::Request"] = { { "NE_T_EE", "f64", 16 }, },
      ["SetNEToEE::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["SetLoad::Request"] = { { "m_load", "f64", 1 }, { "F_x_Cload", "f64", 3 }, { "I_load", "f64", 9 }, },
      ["SetLoad::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["AutomaticErrorRecovery::Response"] = { { "status", "u8", 1, "AutomaticErrorRecovery::Status" }, },
      ["GetCartesianLimit::Request"] = { { "id", "i32", 1 }, },
      ["GetCartesianLimit::Response"] = {
        { "status", "u8", 1, "GetterSetterCommandBase::Status" }, { "object_world_size", "f64", 3 },
        { "object_frame", "f64", 16 }, { "object_activation", "bool", 1 },
      },
      ["SetFilters::Request"] = {
        { "joint_position_filter_frequency", "f64", 1 }, { "joint_velocity_filter_frequency", "f64", 1 },
        { "cartesian_position_filter_frequency", "f64", 1 }, { "cartesian_velocity_filter_frequency", "f64", 1 },
        { "controller_filter_frequency", "f64", 1 },
      },
      ["SetFilters::Response"] = { { "status", "u8", 1, "GetterSetterCommandBase::Status" }, },
      ["LoadModelLibrary::Request"] = { { "architecture", "u8", 1 }, { "system", "u8", 1 }, },
      ["LoadModelLibrary::Response"] = { { "status", "u8", 1, "LoadModelLibrary::Status" }, },
    },
  },
  {
    name = "hand", prefix = "franka.hand", version = 3, port = 1338, header = 10,
    state = "GripperState",
    commands = {
      [0] = { "Connect", "Connect::Request", "Connect::Response" },
      [1] = { "Homing", nil, "Homing::Response", long = true },
      [2] = { "Grasp", "Grasp::Request", "Grasp::Response", long = true },
      [3] = { "Move", "Move::Request", "Move::Response", long = true },
      [4] = { "Stop", nil, "Stop::Response", long = true },
    },
    enums = {
      ["Command"] = { [0] = "Connect", [1] = "Homing", [2] = "Grasp", [3] = "Move", [4] = "Stop", },
      ["CommandBase::Status"] = { [0] = "Success", [1] = "Fail", [2] = "Unsuccessful", [3] = "Aborted", },
      ["Connect::Status"] = { [0] = "Success", [1] = "IncompatibleLibraryVersion", },
    },
    structs = {
      ["Connect::Request"] = { { "version", "u16", 1 }, { "udp_port", "u16", 1 }, },
      ["Connect::Response"] = { { "status", "u16", 1, "Connect::Status" }, { "version", "u16", 1 }, },
      ["Homing::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["Grasp::Request"] = {
        { "width", "f64", 1 }, { "epsilon.inner", "f64", 1 }, { "epsilon.outer", "f64", 1 }, { "speed", "f64", 1 },
        { "force", "f64", 1 },
      },
      ["Grasp::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["Move::Request"] = { { "width", "f64", 1 }, { "speed", "f64", 1 }, },
      ["Move::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["Stop::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["GripperState"] = {
        { "message_id", "u32", 1 }, { "width", "f64", 1 }, { "max_width", "f64", 1 }, { "is_grasped", "bool", 1 },
        { "temperature", "u16", 1 },
      },
    },
  },
  {
    name = "vacuum gripper", prefix = "franka.vacuum", version = 1, port = 1339, header = 10,
    state = "VacuumGripperState",
    commands = {
      [0] = { "Connect", "Connect::Request", "Connect::Response" },
      [1] = { "Vacuum", "Vacuum::Request", "Vacuum::Response", long = true },
      [2] = { "DropOff", "DropOff::Request", "DropOff::Response", long = true },
      [3] = { "Stop", nil, "Stop::Response", long = true },
    },
    enums = {
      ["Command"] = { [0] = "Connect", [1] = "Vacuum", [2] = "DropOff", [3] = "Stop", },
      ["Profile"] = { [0] = "P0", [1] = "P1", [2] = "P2", [3] = "P3", },
      ["DeviceStatus"] = { [0] = "Green", [1] = "Yellow", [2] = "Orange", [3] = "Red", },
      ["CommandBase::Status"] = { [0] = "Success", [1] = "Fail", [2] = "Unsuccessful", [3] = "Aborted", },
      ["Connect::Status"] = { [0] = "Success", [1] = "IncompatibleLibraryVersion", },
    },
    structs = {
      ["Connect::Request"] = { { "version", "u16", 1 }, { "udp_port", "u16", 1 }, },
      ["Connect::Response"] = { { "status", "u16", 1, "Connect::Status" }, { "version", "u16", 1 }, },
      ["Vacuum::Request"] = { { "vacuum", "u8", 1 }, { "profile", "u8", 1, "Profile" }, { "timeout", "i64", 1 }, },
      ["Vacuum::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["DropOff::Request"] = { { "timeout", "i64", 1 }, },
      ["DropOff::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["Stop::Response"] = { { "status", "u16", 1, "CommandBase::Status" }, },
      ["VacuumGripperState"] = {
        { "message_id", "u32", 1 }, { "in_control_range", "bool", 1 }, { "part_detached", "bool", 1 },
        { "part_present", "bool", 1 }, { "device_status", "u8", 1, "DeviceStatus" }, { "actual_power", "i32", 1 },
        { "vacuum", "i32", 1 },
      },
    },
  },
}
local ERRORS = {
  [0] = "joint_position_limits_violation", [1] = "cartesian_position_limits_violation",
  [2] = "self_collision_avoidance_violation", [3] = "joint_velocity_violation", [4] = "cartesian_velocity_violation",
  [5] = "force_control_safety_violation", [6] = "joint_reflex", [7] = "cartesian_reflex",
  [8] = "max_goal_pose_deviation_violation", [9] = "max_path_pose_deviation_violation",
  [10] = "cartesian_velocity_profile_safety_violation", [11] = "joint_position_motion_generator_start_pose_invalid",
  [12] = "joint_motion_generator_position_limits_violation",
  [13] = "joint_motion_generator_velocity_limits_violation", [14] = "joint_motion_generator_velocity_discontinuity",
  [15] = "joint_motion_generator_acceleration_discontinuity",
  [16] = "cartesian_position_motion_generator_start_pose_invalid",
  [17] = "cartesian_motion_generator_elbow_limit_violation",
  [18] = "cartesian_motion_generator_velocity_limits_violation",
  [19] = "cartesian_motion_generator_velocity_discontinuity",
  [20] = "cartesian_motion_generator_acceleration_discontinuity",
  [21] = "cartesian_motion_generator_elbow_sign_inconsistent",
  [22] = "cartesian_motion_generator_start_elbow_invalid",
  [23] = "force_controller_desired_force_tolerance_violation", [24] = "start_elbow_sign_inconsistent",
  [25] = "communication_constraints_violation", [26] = "power_limit_violation",
  [27] = "cartesian_motion_generator_joint_position_limits_violation",
  [28] = "cartesian_motion_generator_joint_velocity_limits_violation",
  [29] = "cartesian_motion_generator_joint_velocity_discontinuity",
  [30] = "cartesian_motion_generator_joint_acceleration_discontinuity",
  [31] = "cartesian_position_motion_generator_invalid_frame_flag", [32] = "controller_torque_discontinuity",
  [33] = "joint_p2p_insufficient_torque_for_planning", [34] = "tau_J_range_violation", [35] = "instability_detected",
  [36] = "joint_move_in_wrong_direction", [37] = "cartesian_spline_motion_generator_violation",
  [38] = "joint_via_motion_generator_planning_joint_limit_violation",
  [39] = "base_acceleration_initialization_timeout", [40] = "base_acceleration_invalid_reading",
}
-- end of the tables

local franka = Proto("franka", "Franka Control Interface")

local REPLY_LATE = 1.0 -- s: nothing but a motion, a recovery or an action of an end effector takes longer
local SUCCESS_RATE_LOW = 0.9

-- What follows is kept by connection, and reset for each capture.
local sessions -- by client address and UDP port: list of { frame, protocol, ... }, in the order of the capture
local streams -- by addresses and TCP ports: list of { frame, protocol, requests = { [id] = {...} } }, in that order
local notes -- by frame: list of { expert, text }, found in the first pass

function franka.init()
  sessions, streams, notes = {}, {}, {}
end

-- Fields: one per name, whatever the version; numbers are shown as 64-bit floats.

local FTYPES = {
  f32 = ProtoField.double, f64 = ProtoField.double, bool = ProtoField.bool,
  u8 = ProtoField.uint32, u16 = ProtoField.uint32, u32 = ProtoField.uint32, u64 = ProtoField.uint64,
  i32 = ProtoField.int32, i64 = ProtoField.int64,
}
local SIZES = { f32 = 4, f64 = 8, bool = 1, u8 = 1, u16 = 2, u32 = 4, u64 = 8, i32 = 4, i64 = 8 }
local READERS = {
  f32 = function(range) return range:le_float() end,
  f64 = function(range) return range:le_float() end,
  bool = function(range) return range:uint() ~= 0 end,
  u8 = function(range) return range:uint() end,
  u16 = function(range) return range:le_uint() end,
  u32 = function(range) return range:le_uint() end,
  u64 = function(range) return range:le_uint64() end,
  i32 = function(range) return range:le_int() end,
  i64 = function(range) return range:le_int64() end,
}

local fields = {}
local function field(abbrev, name, make, ...)
  if not fields[abbrev] then
    fields[abbrev] = make(abbrev, name, ...)
  end
  return fields[abbrev]
end

local f = {
  message = field("franka.message", "Message", ProtoField.string),
  number = field("franka.number", "Command", ProtoField.uint32),
  id = field("franka.id", "Request", ProtoField.uint32),
  size = field("franka.size", "Size", ProtoField.uint32),
  model = field("franka.reply.model", "Model", ProtoField.string),
  library = field("franka.reply.library", "Library", ProtoField.bytes),
  error = field("franka.state.error", "Error", ProtoField.string),
  reflex = field("franka.state.reflex", "Error that ended the last motion", ProtoField.string),
  reply_in = field("franka.reply_in", "Reply in", ProtoField.framenum, base.NONE, frametype.RESPONSE),
  request_in = field("franka.request_in", "Request in", ProtoField.framenum, base.NONE, frametype.REQUEST),
  reply_time = field("franka.reply_time", "Time since the request (s)", ProtoField.double),
  state_in = field("franka.state_in", "State in", ProtoField.framenum, base.NONE, frametype.REQUEST),
  turnaround = field("franka.turnaround", "Time since the state (s)", ProtoField.double),
}

-- Field names are those of the layouts; the parts of a command have none of their own.
local function short(name)
  return (name:gsub("^motion%.", ""):gsub("^control%.", ""))
end

for _, protocol in ipairs(PROTOCOLS) do
  local function define(struct, prefix)
    for _, row in ipairs(protocol.structs[struct] or {}) do
      local name = short(row[1])
      field(protocol.prefix .. "." .. prefix .. "." .. name, name, FTYPES[row[2]])
    end
  end
  define(protocol.state, "state")
  if protocol.command then define(protocol.command, "command") end
  for _, command in pairs(protocol.commands) do
    if command[2] then define(command[2], "request") end
    define(command[3], "reply")
  end
end

local list = {}
for _, one in pairs(fields) do list[#list + 1] = one end
franka.fields = list

local function finding(abbrev, text, group, severity)
  return ProtoExpert.new("franka." .. abbrev, text, group, severity)
end

local e = {
  gap = finding("gap", "States are missing", expert.group.SEQUENCE, expert.severity.WARN),
  order = finding("order", "State is older than the one before", expert.group.SEQUENCE, expert.severity.WARN),
  late = finding("late", "Command is late", expert.group.SEQUENCE, expert.severity.WARN),
  unanswered = finding("unanswered", "State of a motion has no command", expert.group.SEQUENCE, expert.severity.NOTE),
  failed = finding("failed", "Request failed", expert.group.RESPONSE_CODE, expert.severity.WARN),
  slow = finding("slow", "Reply is slow", expert.group.RESPONSE_CODE, expert.severity.NOTE),
  unasked = finding("unasked", "Reply to no request", expert.group.SEQUENCE, expert.severity.WARN),
  reflex = finding("reflex", "Robot reports an error", expert.group.RESPONSE_CODE, expert.severity.ERROR),
  rate = finding("rate", "Success rate of commands is low", expert.group.SEQUENCE, expert.severity.NOTE),
  length = finding("length", "Length is not that of the layout", expert.group.MALFORMED, expert.severity.ERROR),
  unknown = finding("unknown", "No such command", expert.group.PROTOCOL, expert.severity.WARN),
}
local experts = {}
for _, one in pairs(e) do experts[#experts + 1] = one end
franka.experts = experts

-- In the first pass, notes what is wrong with a frame; in every pass, shows it.
local function note(pinfo, what, text)
  if pinfo.visited then return end
  local frame = notes[pinfo.number] or {}
  frame[#frame + 1] = { what, text }
  notes[pinfo.number] = frame
end

local function show_notes(pinfo, tree, from)
  for i = from + 1, #(notes[pinfo.number] or {}) do
    local one = notes[pinfo.number][i]
    tree:add_proto_expert_info(one[1], one[2])
  end
end

local function count_notes(pinfo)
  return pinfo.visited and 0 or #(notes[pinfo.number] or {})
end

-- Adds the fields of a struct; returns the value of each that is not an array, and where it ends. `nil` if the bytes are
-- too few.
local function add_struct(protocol, struct, prefix, tvb, offset, tree)
  local values = {}
  for _, row in ipairs(protocol.structs[struct]) do
    local name, kind, count, enum = short(row[1]), row[2], row[3], row[4]
    local size = SIZES[kind]
    if offset + size * count > tvb:len() then return nil, offset end
    local shown = fields[protocol.prefix .. "." .. prefix .. "." .. name]
    local flags = name == "errors" and f.error or name == "reflex_reason" and f.reflex
    for i = 0, count - 1 do
      local range = tvb(offset + i * size, size)
      local value = READERS[kind](range)
      if flags then
        if value then
          tree:add(flags, range, ERRORS[i])
          values[name] = (values[name] and values[name] .. ", " or "") .. ERRORS[i]
        end
      else
        local item = tree:add(shown, range, value)
        if enum then
          local text = protocol.enums[enum][value] or "undefined"
          item:append_text(" (" .. text .. ")")
          values[name .. "_text"] = text
        elseif count > 1 then
          item:prepend_text("[" .. i .. "] ")
        end
        values[name] = value
      end
    end
    offset = offset + size * count
  end
  return values, offset
end

-- The stream -------------------------------------------------------------------------------------------------------------

-- The stream of a message to or from the robot. Its number, `tcp.stream`, is not to be had in a pass that makes no tree.
local function stream_of(pinfo, to_robot, begins)
  local source = tostring(pinfo.src) .. " " .. pinfo.src_port
  local destination = tostring(pinfo.dst) .. " " .. pinfo.dst_port
  local key = to_robot and source .. " " .. destination or destination .. " " .. source
  local list = streams[key] or {}
  streams[key] = list
  -- The ports of a connection may serve another one later.
  if not pinfo.visited and (begins or #list == 0) then
    list[#list + 1] = { frame = pinfo.number, requests = {} }
  end
  local found
  for _, stream in ipairs(list) do
    if stream.frame <= pinfo.number then found = stream end
  end
  return found or { requests = {} }
end

local function device_of(port)
  for _, protocol in ipairs(PROTOCOLS) do
    if protocol.port == port then return protocol end
  end
end

-- The protocol of this port and version; that of the port alone if the version is not known.
local function with_version(port, version)
  local found
  for _, protocol in ipairs(PROTOCOLS) do
    if protocol.port == port and (protocol.version == version or not found) then found = protocol end
  end
  return found
end

local datagrams = Proto("franka_udp", "Franka Control Interface, datagrams")

local function on_connect(pinfo, stream, values, port)
  stream.protocol = with_version(port, values.version)
  if pinfo.visited then return end
  local key = tostring(pinfo.src) .. " " .. values.udp_port
  sessions[key] = sessions[key] or {}
  table.insert(sessions[key], { frame = pinfo.number, protocol = stream.protocol, states = {}, frames = {} })
  DissectorTable.get("udp.port"):add(values.udp_port, datagrams)
end

local function on_request(pinfo, tree, stream, id, name)
  if not pinfo.visited then
    stream.requests[id] = { frame = pinfo.number, time = pinfo.abs_ts, name = name, replies = {} }
  end
  local request = stream.requests[id]
  for _, frame in ipairs(request and request.replies or {}) do
    tree:add(f.reply_in, frame):set_generated()
  end
end

local function on_reply(pinfo, tree, stream, id, command, values)
  local request = stream.requests[id]
  if not request then
    note(pinfo, e.unasked, "No request " .. id .. " is in the capture")
  else
    local time = pinfo.abs_ts - request.time
    if not pinfo.visited then table.insert(request.replies, pinfo.number) end
    tree:add(f.request_in, request.frame):set_generated()
    tree:add(f.reply_time, time):set_generated()
    if time > REPLY_LATE and not command.long then
      note(pinfo, e.slow, string.format("%s was answered after %.3f s", command[1], time))
    end
  end
  local status = values and values.status_text
  if status and status ~= "Success" and status ~= "MotionStarted" then
    note(pinfo, e.failed, command[1] .. ": " .. status)
  end
end

local function message_length(header)
  return function(tvb, _, offset)
    local size = tvb(offset + header - 4, 4):le_uint()
    return size < header and header or size
  end
end

local function dissect_message(tvb, pinfo, root)
  local to_robot = device_of(pinfo.dst_port) ~= nil
  local port = to_robot and pinfo.dst_port or pinfo.src_port
  local header = device_of(port).header
  local wide = header == 12 and 4 or 2
  local code, id = tvb(0, wide):le_uint(), tvb(wide, 4):le_uint()
  local stream = stream_of(pinfo, to_robot, to_robot and code == 0)
  local protocol = stream.protocol or device_of(port)

  -- The version decides about numbers and layouts, and stands in the first request.
  if code == 0 and to_robot and tvb:len() >= header + 4 then
    protocol = with_version(port, tvb(header, 2):le_uint())
  end
  local command = protocol.commands[code]
  local name = command and command[1] or "Command " .. code
  local text = name .. (to_robot and "" or " reply")
  local tree = root:add(franka, tvb(), "Franka " .. protocol.name .. ", " .. text)
  local before = count_notes(pinfo)
  tree:add(f.message, tvb(0, wide), name)
  tree:add(f.number, tvb(0, wide), code)
  tree:add(f.id, tvb(wide, 4), id)
  tree:add(f.size, tvb(wide + 4, 4), tvb(wide + 4, 4):le_uint())

  local values
  if not command then
    note(pinfo, e.unknown, "Command " .. code .. " is not one of " .. protocol.name .. " " .. protocol.version)
  else
    local struct, prefix = command[to_robot and 2 or 3], to_robot and "request" or "reply"
    local stop = header
    if struct then
      values, stop = add_struct(protocol, struct, prefix, tvb, header, tree)
      if not values then note(pinfo, e.length, name .. " has only " .. tvb:len() .. " bytes") end
    end
    if values and not to_robot and stop < tvb:len() then
      if name == "GetRobotModel" then tree:add(f.model, tvb(stop)) end
      if name == "LoadModelLibrary" then tree:add(f.library, tvb(stop)) end
    end
    if values and values.status_text then text = text .. ": " .. values.status_text end
  end
  if to_robot then
    if code == 0 and values then on_connect(pinfo, stream, values, port) end
    on_request(pinfo, tree, stream, id, name)
  elseif command then
    on_reply(pinfo, tree, stream, id, command, values)
  end
  pinfo.cols.protocol = "FRANKA"
  pinfo.cols.info:append(" " .. text .. " #" .. id)
  pinfo.cols.info:fence()
  show_notes(pinfo, tree, before)
  return tvb:len()
end

function franka.dissector(tvb, pinfo, root)
  local protocol = device_of(pinfo.dst_port) or device_of(pinfo.src_port)
  if not protocol then return 0 end
  pinfo.cols.info = ""
  dissect_tcp_pdus(tvb, root, protocol.header, message_length(protocol.header), dissect_message)
  return tvb:len()
end

-- The datagrams ----------------------------------------------------------------------------------------------------------

-- The session to which a datagram of the client's `key` belongs: the newest that began before.
local function session_of(key, frame)
  local found
  for _, session in ipairs(sessions[key] or {}) do
    if session.frame < frame then found = session end
  end
  return found
end

local function in_motion(values)
  return values.robot_mode_text == "Move" and values.motion_generator_mode_text ~= "Idle"
end

local function on_state(pinfo, session, values)
  local id = tonumber(tostring(values.message_id))
  if not pinfo.visited then
    local last = session.last
    if last and id > last.id + 1 and session.protocol.command then
      note(pinfo, e.gap, string.format("%d states between %d and %d are missing", id - last.id - 1, last.id, id))
    elseif last and id <= last.id then
      note(pinfo, e.order, string.format("State %d after %d", id, last.id))
    end
    if last and last.motion and not last.answered and last.id < id then
      note(pinfo, e.unanswered, "No command for state " .. last.id .. " so far")
    end
    local rate = values.control_command_success_rate
    if in_motion(values) and rate and rate < SUCCESS_RATE_LOW and session.commanded then
      note(pinfo, e.rate, string.format("%.2f of the last commands arrived in time", rate))
    end
    if values.errors and values.errors ~= session.errors then note(pinfo, e.reflex, values.errors) end
    session.errors = values.errors
    if not last or id > last.id then
      session.last = { id = id, motion = in_motion(values), answered = false }
    end
    session.states[id] = { frame = pinfo.number, time = pinfo.abs_ts }
  end
  return string.format("State %d", id) .. (values.robot_mode_text and " " .. values.robot_mode_text or "")
end

local function on_command(pinfo, tree, session, values)
  local id = tonumber(tostring(values.message_id))
  if not pinfo.visited then
    session.commanded = true
    local last = session.last
    if last and id == last.id then last.answered = true end
    if last and id < last.id then
      note(pinfo, e.late, string.format("Command for state %d, and %d has been sent", id, last.id))
    end
    session.frames[pinfo.number] = session.states[id]
  end
  local state = session.frames[pinfo.number]
  if state then
    tree:add(f.state_in, state.frame):set_generated()
    tree:add(f.turnaround, pinfo.abs_ts - state.time):set_generated()
  end
  local last = values.motion_generation_finished or values.torque_command_finished
  return string.format("Command %d", id) .. (last and ", the last" or "")
end

function datagrams.dissector(tvb, pinfo, root)
  local to_client = session_of(tostring(pinfo.dst) .. " " .. pinfo.dst_port, pinfo.number)
  local session = to_client or session_of(tostring(pinfo.src) .. " " .. pinfo.src_port, pinfo.number)
  local protocol = session and session.protocol
  local struct = protocol and (to_client and protocol.state or protocol.command)
  if not struct then return 0 end
  local tree = root:add(franka, tvb(), "Franka " .. protocol.name .. ", " .. (to_client and "state" or "command"))
  local before = count_notes(pinfo)
  local values, stop = add_struct(protocol, struct, to_client and "state" or "command", tvb, 0, tree)
  pinfo.cols.protocol = "FRANKA"
  if not values or stop ~= tvb:len() then
    note(pinfo, e.length, string.format("%s has %d bytes, the layout %s", struct, tvb:len(), values and stop or "more"))
  end
  if values then
    pinfo.cols.info = to_client and on_state(pinfo, session, values) or on_command(pinfo, tree, session, values)
  end
  show_notes(pinfo, tree, before)
  return tvb:len()
end

for _, protocol in ipairs(PROTOCOLS) do
  DissectorTable.get("tcp.port"):add(protocol.port, franka)
end
