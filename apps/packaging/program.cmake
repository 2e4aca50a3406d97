# What is installed of the program: itself, its manual and completions, configurations, mappings.
set(generated ${CMAKE_CURRENT_BINARY_DIR}/generated)
function(foucault_generate WHAT FILE)
  get_filename_component(folder ${generated}/${FILE} DIRECTORY)
  add_custom_command(
    TARGET foucault POST_BUILD
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND foucault --generate ${WHAT} > ${generated}/${FILE}
    VERBATIM)
endfunction()
foucault_generate(man man/man1/foucault.1)
foucault_generate(bash bash-completion/completions/foucault)
foucault_generate(zsh zsh/vendor-completions/_foucault) # where Debian's zsh looks

install(TARGETS foucault RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS ${parts} LIBRARY DESTINATION lib/foucault COMPONENT program)  # see load_part()
install(DIRECTORY ${generated}/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
install(DIRECTORY configs ${PROJECT_SOURCE_DIR}/rawlog/mappings
        DESTINATION ${CMAKE_INSTALL_DATADIR}/foucault COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libfoucault-dev
        COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright COMPONENT program
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/foucault)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright COMPONENT development
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libfoucault-dev)
