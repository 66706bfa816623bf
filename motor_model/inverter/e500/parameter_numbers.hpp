// FR-E500 parameter numbers by name (motor_model/families/mitsubishi_e500/parameters.csv).
#pragma once

namespace vinv::inverter::e500::pr {

enum : unsigned {
  kTorqueBoost = 0, kMaximumFrequency = 1, kMinimumFrequency = 2, kBaseFrequency = 3, kSpeedHigh = 4, kSpeedMiddle = 5,
  kSpeedLow = 6, kAcceleration = 7, kDeceleration = 8, kThermal = 9, kDcBrakeFrequency = 10, kDcBrakeTime = 11,
  kDcBrakeVoltage = 12, kStartingFrequency = 13, kLoadPattern = 14, kJogFrequency = 15, kJogTime = 16, kMrsSense = 17,
  kHighSpeedMaximum = 18, kBaseVoltage = 19, kRampReference = 20, kTimeIncrement = 21, kStallLevel = 22,
  kStallDoubleSpeed = 23, kSpeed4 = 24, kPattern = 29, kRegenerative = 30, kJump1A = 31, kSpeedDisplay = 37,
  kVoltageInputGain = 38, kCurrentInputGain = 39, kUpToFrequency = 41, kDetection = 42, kDetectionReverse = 43,
  kSecondRamp = 44, kSecondDeceleration = 45, kSecondBoost = 46, kSecondBaseFrequency = 47, kSecondThermal = 48,
  kDisplay = 52, kFrequencyFullScale = 55, kCurrentFullScale = 56, kRestart = 57, kRestartCushion = 58,
  kRemoteSetting = 59, kShortestMode = 60, kShortestReference = 61, kShortestAcceleration = 62,
  kShortestDeceleration = 63, kRetrySelection = 65, kStallReductionStart = 66, kRetries = 67, kRetryWait = 68,
  kRetryCount = 69, kBrakeDuty = 70, kAppliedMotor = 71, kCarrier = 72, kVoltageRange = 73, kInputFilter = 74,
  kResetSelection = 75, kWriteDisable = 77, kReversePrevention = 78, kOperationMode = 79, kMotorCapacity = 80,
  kExcitingCurrent = 82, kMotorVoltage = 83, kMotorFrequency = 84, kMotorR1 = 90, kAutoTuning = 96, kPidAction = 128,
  kPidBand = 129, kPidIntegral = 130, kPidUpper = 131, kPidLower = 132, kPidSetPoint = 133, kPidDerivative = 134,
  kCurrentDetection = 150, kCurrentDetectionTime = 151, kZeroCurrent = 152, kZeroCurrentTime = 153,
  kStallSelection = 156, kAmSelection = 158, kUserGroup = 160, kHourMeterClear = 171, kGroup1Add = 173,
  kGroup1Remove = 174, kGroup2Add = 175, kGroup2Remove = 176, kRlFunction = 180, kRmFunction = 181,
  kRhFunction = 182, kMrsFunction = 183, kRunFunction = 190, kFuFunction = 191, kAbcFunction = 192, kSpeed8 = 232,
  kFan = 244, kRatedSlip = 245, kSlipResponse = 246, kSlipConstantOutput = 247, kEarthFaultAtStart = 249,
  kStopSelection = 250, kOutputPhaseLoss = 251, kOperationRight = 338, kSpeedRight = 339, kLinkStart = 340,
  kEepromWrite = 342, kAmCalibration = 901, kVoltageBias = 902, kVoltageGain = 903, kCurrentBias = 904,
  kCurrentGain = 905,
};

}  // namespace vinv::inverter::e500::pr
