! dummy.cpp in Fortran: dummy_fortran One|Two CONFIG
program dummy_fortran
  implicit none
  character(len=50) :: name, config, mesh, own, other
  integer :: ids(3), ongoing, required, steps
  double precision :: positions(9), values(9), dt

  call get_command_argument(1, name)
  call get_command_argument(2, config)
  mesh = trim(name)//'-Mesh'
  own = 'Data-'//trim(name)
  other = 'Data-One'
  if (name == 'One') other = 'Data-Two'
  positions = (/ 0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 2d0, 0d0, 0d0 /)
  steps = 0

  call precicef_create(name, config, 0, 1)
  call precicef_set_vertices(mesh, 3, positions, ids)
  call precicef_initialize()
  call precicef_is_coupling_ongoing(ongoing)
  do while (ongoing == 1)
    call precicef_requires_writing_checkpoint(required)
    if (required == 1) print '(a)', 'saves'
    call precicef_get_max_time_step_size(dt)
    call precicef_read_data(mesh, other, 3, ids, dt, values)
    steps = steps + 1
    values = values + 1
    call precicef_write_data(mesh, own, 3, ids, values)
    call precicef_advance(dt)
    call precicef_requires_reading_checkpoint(required)
    if (required == 1) then
      print '(a)', 'goes back'
    else
      print '(a)', 'goes on'
    end if
    call precicef_is_coupling_ongoing(ongoing)
  end do
  call precicef_finalize()
  print '(i0, a, g0.6)', steps, ' steps, last value ', values(9)
end program dummy_fortran
