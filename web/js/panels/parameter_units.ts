/** Units of parameters of Gazebo's plugins, by their names. Pure. */

const NAMES: Record<string, string> = {
  'm': 'wheelSeparation wheelDiameter wheelRadius wheel_separation wheel_separation_x wheel_separation_y ' +
    'wheel_separation_w wheel_separation_h wheel_diameter wheel_radius wheel_base encoderWheelSeparation ' +
    'encoderWheelDiameter actuatedWheelDiameter min_range max_range rangeMinDepth rangeMaxDepth pointCloudCutoff ' +
    'pointCloudCutoffMax hackBaseline floor_height referenceAltitude horPosStdDev verPosStdDev',
  'm/s': 'windSpeedMean max_trans_velocity horVelStdDev verVelStdDev',
  'm/s²': 'wheelAcceleration',
  'rad/s': 'maxRotVelocity max_rot_velocity',
  'N': 'windForceMean windGustForceMean',
  'N m': 'torque wheelTorque',
  's': 'update_period updatePeriod timeConstantUp timeConstantDown door_wait_time velocity_command_timeout ' +
    'cmd_vel_timeout windGustStart windGustDuration stop_trajectory_duration',
  'Hz': 'updateRate update_rate updateRateHZ odometryRate publish_rate motorStatusRate controlRate state_publish_rate',
  '°': 'referenceLatitude referenceLongitude referenceHeading',
  'kg/m³': 'fluid_density air_density',
  'm²': 'area',
  'm³': 'volume',
};

const UNITS = new Map(Object.entries(NAMES).flatMap(([unit, names]) =>
  names.split(' ').map((name) => [name, unit] as const)));

/** The unit of a parameter that is a number; undefined for one without a unit, or an unknown one. */
export const parameterUnit = (name: string): string|undefined => UNITS.get(name);
